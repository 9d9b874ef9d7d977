-- The ordinal of the last point of a sweep, or of the last that one of its runs verifies; 0 without any.
-- ?1 sweep.
SELECT max(coalesce((SELECT max(ordinal) FROM point WHERE sweep_id = ?1 AND verifies = 0), 0),
           coalesce((SELECT max(ordinal) FROM point WHERE sweep_id = ?1 AND verifies = 1), 0))
