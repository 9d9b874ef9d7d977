-- The work items that are done and have no result.
SELECT key FROM work LEFT JOIN result ON work_key = key WHERE state = 'done' AND work_key IS NULL ORDER BY key
