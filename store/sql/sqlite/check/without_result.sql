-- Counts the work items that are done and have no result.
SELECT count(*) FROM work LEFT JOIN result ON work_key = key WHERE state = 'done' AND work_key IS NULL
