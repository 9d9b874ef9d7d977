-- Raises the version of a sweep beyond events that were stored at once.
-- $1 sweep, $2 their number; one more is added where it is finished.
UPDATE sweep SET version = version + $2 + (finished IS NOT NULL)::int WHERE id = $1
