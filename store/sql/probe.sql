-- name: INSERT_SCENARIO
-- The scratch scenario.
-- $1 its hash.
INSERT INTO scenario (hash, text) VALUES ($1, '')

-- name: INSERT_TURN
-- The turn of an owner that nobody is.
INSERT INTO owner_turn (owner, vtime) VALUES ('', 0)

-- name: INSERT_WORK
-- The scratch work item, ready to be claimed.
-- $1 its key and the hash of its scenario, $2 version of the numbers.
INSERT INTO work (key, physics_version, base, owner, state, priority, vtime, ready_at, created, changed)
VALUES ($1, $2, $1, '', 'queued', 0, 0, 0, 0, 0)
