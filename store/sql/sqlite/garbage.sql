-- name: DELETE_SCENARIOS
-- Deletes scenarios without a work item.
DELETE FROM scenario WHERE NOT EXISTS (SELECT 1 FROM work WHERE work.base = scenario.hash)

-- name: TRUNCATE_LOG
-- Moves the write-ahead log into the database and truncates it.
PRAGMA wal_checkpoint(TRUNCATE)
