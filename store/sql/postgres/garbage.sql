-- name: DELETE_SCENARIOS
-- Deletes the scenarios that no work item changes any more: all work is gone through once.
DELETE FROM scenario WHERE hash NOT IN (SELECT DISTINCT base FROM work WHERE base IS NOT NULL)

-- name: TRUNCATE_LOG
-- Nothing: the server keeps its write-ahead log, and its vacuum gives pages back.
SELECT 1 WHERE false
