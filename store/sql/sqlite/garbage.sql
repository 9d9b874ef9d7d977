-- name: DELETE_SCENARIOS
-- Deletes the scenarios that no work item changes any more.
DELETE FROM scenario WHERE NOT EXISTS (SELECT 1 FROM work WHERE work.base = scenario.hash)

-- name: TRUNCATE_LOG
-- Folds the write-ahead log into the database and cuts it off.
PRAGMA wal_checkpoint(TRUNCATE)
