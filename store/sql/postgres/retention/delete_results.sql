-- Deletes the results that no sweep has any more; their artifacts go with them.
DELETE FROM result WHERE NOT EXISTS (SELECT 1 FROM point WHERE point.work_key = result.work_key)
