-- Deletes the final work items that no sweep has any more.
DELETE FROM work
WHERE NOT is_open
  AND NOT EXISTS (SELECT 1 FROM point WHERE point.work_key = work.key)
  AND NOT EXISTS (SELECT 1 FROM result WHERE result.work_key = work.key)
