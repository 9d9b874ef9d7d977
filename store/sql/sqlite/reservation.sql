-- name: RESERVE
-- Reserves blobs for rows to come, but those that are being deleted: they are not deleted until then. Who has reserved one for longer
-- keeps it.
-- $1 their names, a JSON array without repetitions, $2 for how long [ms].
-- Gives: those that are reserved.
INSERT INTO upload (blob, expires)
SELECT value, (SELECT now FROM clock) + $2 FROM json_each($1)
WHERE NOT EXISTS (SELECT 1 FROM removal WHERE blob = value AND expires > (SELECT now FROM clock))
ON CONFLICT (blob) DO UPDATE SET expires = max(upload.expires, excluded.expires)
RETURNING blob

-- name: RESERVE_AT_ONCE
-- Nothing: there, statements are no messages, and it is done step by step.
-- $1 work item, $2 fencing token, $3 worker, $4 length of the lease [ms], $5 names of the blobs, a JSON array without repetitions, $6 for
-- how long they are reserved [ms].
-- Gives: nothing.
SELECT 0, NULL WHERE coalesce($1, $2, $3, $4, $5, $6) IS NULL

-- name: UNRESERVED
-- Those of some blobs that are not reserved, or not any more.
-- $1 their names, a JSON array.
SELECT value FROM json_each($1)
WHERE NOT EXISTS (SELECT 1 FROM upload WHERE blob = value AND expires > (SELECT now FROM clock))
