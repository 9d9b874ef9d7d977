-- name: END_LEASES
-- Expires the leases of a dead process: the next search ends them.
-- $1 host, $2 process, $3 note about its end, or null.
UPDATE work SET lease_until = (SELECT now FROM clock) - 1, worker_note = coalesce($3, worker_note)
WHERE state = 'leased' AND lease_owner IN (SELECT id FROM worker WHERE host = $1 AND process = $2)

-- name: LIST
-- Workers with a recent heartbeat, oldest first. A heartbeat too far in the future, as after the clock was set back, does not count.
-- $1 largest age of the heartbeat [ms].
SELECT id, host, process, version, physics_version, started, last_seen FROM worker
WHERE last_seen > (SELECT now FROM clock) - $1 AND last_seen < (SELECT now FROM clock) + $1
ORDER BY started, id

-- name: REGISTER
-- Registers a worker, or renews its heartbeat.
-- $1 worker, $2 host, $3 process, $4 version of its program, $5 physics version.
INSERT INTO worker (id, host, process, version, physics_version, started, last_seen)
VALUES ($1, $2, $3, $4, $5, (SELECT now FROM clock), (SELECT now FROM clock))
ON CONFLICT (id) DO UPDATE SET last_seen = excluded.last_seen

-- name: REMOVE
-- Removes a worker.
-- $1 worker.
DELETE FROM worker WHERE id = $1

-- name: REMOVE_PROCESS
-- Removes the workers of a dead process.
-- $1 host, $2 process.
DELETE FROM worker WHERE host = $1 AND process = $2
