-- The speed measured last of any machine.
-- $1 version of the numbers.
SELECT speed FROM machine_speed WHERE physics_version = $1 ORDER BY measured DESC, host LIMIT 1
