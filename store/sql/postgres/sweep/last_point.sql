-- The ordinal of the last point of a sweep, or of the last that one of its runs verifies; 0 without any.
-- $1 sweep.
SELECT greatest(coalesce((SELECT max(ordinal) FROM point WHERE sweep_id = $1 AND NOT verifies), 0),
           coalesce((SELECT max(ordinal) FROM point WHERE sweep_id = $1 AND verifies), 0))
