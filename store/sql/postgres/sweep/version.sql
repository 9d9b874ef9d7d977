-- The version of a sweep.
-- $1 sweep.
SELECT version FROM sweep WHERE id = $1 AND hidden IS NULL
