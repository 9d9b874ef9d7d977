-- name: ENDS_OF_ORDER
-- The first and the last place that is taken in an owner's order; 0 where none is.
-- $1 owner.
-- A query for each end: asked for both at once, SQLite reads all of them.
SELECT coalesce((SELECT min(vtime) FROM work WHERE owner = $1 AND is_open), 0),
       coalesce((SELECT max(vtime) FROM work WHERE owner = $1 AND is_open), 0)

-- name: INSERT_TURN
-- Gives an owner that has had no turn its first.
-- $1 owner.
INSERT INTO owner_turn (owner, vtime) VALUES ($1, 0) ON CONFLICT (owner) DO NOTHING
