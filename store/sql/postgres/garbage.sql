-- name: DELETE_SCENARIOS
-- Deletes scenarios without a work item, in one pass over all work.
DELETE FROM scenario WHERE hash NOT IN (SELECT DISTINCT base FROM work WHERE base IS NOT NULL)

-- name: TRUNCATE_LOG
-- No operation: the server manages its write-ahead log, and autovacuum frees pages.
SELECT 1 WHERE false
