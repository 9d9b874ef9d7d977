-- Registers a worker, or renews its entry.
-- $1 worker, $2 host, $3 process, $4 version of its program, $5 version of its numbers.
INSERT INTO worker (id, host, process, version, physics_version, started, last_seen)
VALUES ($1, $2, $3, $4, $5, (SELECT now FROM clock), (SELECT now FROM clock))
ON CONFLICT (id) DO UPDATE SET last_seen = excluded.last_seen
