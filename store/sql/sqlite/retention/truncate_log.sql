-- Folds the write-ahead log into the database and cuts it off.
PRAGMA wal_checkpoint(TRUNCATE)
