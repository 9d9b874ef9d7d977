-- name: INSERT_SCENARIO
-- Inserts the scratch scenario.
-- $1 its hash.
INSERT INTO scenario (hash, text) VALUES ($1, '')

-- name: INSERT_TURN
-- Inserts the turn of the scratch owner, whose name is empty.
INSERT INTO owner_turn (owner, vtime) VALUES ('', 0)

-- name: INSERT_WORK
-- Inserts the scratch work item, ready to be claimed.
-- $1 its key and the hash of its scenario, $2 physics version.
INSERT INTO work (key, physics_version, base, owner, state, priority, vtime, ready_at, created, changed)
VALUES ($1, $2, $1, '', 'queued', 0, 0, 0, 0, 0)
