-- Reserves a blob for a row to come, unless it is being deleted: it is not deleted until then. Who has reserved it for longer keeps it
-- (migrations/postgres/0004_transitions.sql).
-- $1 blob, $2 for how long [ms].
-- Gives: the blob; nothing if it is being deleted.
SELECT blob FROM reserve_blob($1, $2) AS reserved (blob)
