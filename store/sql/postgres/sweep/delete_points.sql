-- Deletes the first points of a sweep that there are.
-- $1 sweep, $2 up to which ordinal.
DELETE FROM point WHERE sweep_id = $1 AND verifies IN (false, true) AND ordinal <= $2
