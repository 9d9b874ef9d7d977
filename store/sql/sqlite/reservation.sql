-- name: RESERVE
-- Reserves blobs for future rows, except those under deletion: a reserved blob is not deleted. A longer reservation is kept.
-- $1 their names, a JSON array without repetitions, $2 duration [ms].
-- Returns: the reserved ones.
INSERT INTO upload (blob, expires)
SELECT value, (SELECT now FROM clock) + $2 FROM json_each($1)
WHERE NOT EXISTS (SELECT 1 FROM removal WHERE blob = value AND expires > (SELECT now FROM clock))
ON CONFLICT (blob) DO UPDATE SET expires = max(upload.expires, excluded.expires)
RETURNING blob

-- name: RESERVE_AT_ONCE
-- No operation: without round trips single statements suffice.
-- $1 work item, $2 fencing token, $3 worker, $4 length of the lease [ms], $5 names of the blobs, a JSON array without repetitions, $6
-- duration of the reservation [ms].
-- Returns: nothing.
SELECT 0, NULL WHERE coalesce($1, $2, $3, $4, $5, $6) IS NULL

-- name: UNRESERVED
-- Blobs of a list without a valid reservation.
-- $1 their names, a JSON array.
SELECT value FROM json_each($1)
WHERE NOT EXISTS (SELECT 1 FROM upload WHERE blob = value AND expires > (SELECT now FROM clock))
