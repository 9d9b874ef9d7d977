-- name: KEEP_SPEED
-- Stores the speed of a machine, replacing an earlier one.
-- $1 host, $2 physics version, $3 speed, JSON.
INSERT INTO machine_speed (host, physics_version, speed, measured) VALUES ($1, $2, $3, (SELECT now FROM clock))
ON CONFLICT (host, physics_version) DO UPDATE SET speed = excluded.speed, measured = excluded.measured

-- name: LATEST_SPEED
-- Latest measured speed of any machine.
-- $1 physics version.
SELECT speed FROM machine_speed WHERE physics_version = $1 ORDER BY measured DESC, host LIMIT 1
