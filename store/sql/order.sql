-- name: ENDS_OF_ORDER
-- First and last position taken in an owner's order; 0 if there is none.
-- $1 owner.
-- One query for each end: for both at once SQLite scans all rows.
SELECT coalesce((SELECT min(vtime) FROM work WHERE owner = $1 AND is_open), 0),
       coalesce((SELECT max(vtime) FROM work WHERE owner = $1 AND is_open), 0)

-- name: INSERT_TURN
-- Creates the turn of an owner that has none.
-- $1 owner.
INSERT INTO owner_turn (owner, vtime) VALUES ($1, 0) ON CONFLICT (owner) DO NOTHING
