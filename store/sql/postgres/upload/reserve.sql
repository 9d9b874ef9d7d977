-- Reserves blobs for rows to come, but those that are being deleted: they are not deleted until then. Who has reserved one for longer
-- keeps it (migrations/postgres/0001_schema.sql).
-- $1 their names, a JSON array without repetitions, $2 for how long [ms].
-- Gives: those that are reserved.
SELECT blob FROM reserve_blobs($1::json, $2) AS reserved (blob)
