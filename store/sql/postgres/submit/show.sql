-- Shows a sweep whose points are all stored.
-- $1 sweep.
UPDATE sweep SET hidden = NULL WHERE id = $1 AND hidden IS NOT NULL AND NOT cancelled
