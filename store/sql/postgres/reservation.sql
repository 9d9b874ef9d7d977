-- name: RESERVE
-- Reserves blobs for future rows, except those under deletion: a reserved blob is not deleted. A longer reservation is kept
-- (migrations/postgres/0001_schema.sql).
-- $1 their names, a JSON array without repetitions, $2 duration [ms].
-- Returns: the reserved ones.
SELECT blob FROM reserve_blobs($1::json, $2) AS reserved (blob)

-- name: RESERVE_AT_ONCE
-- Reserves blobs as `RESERVE` and extends the lease of computed work as `lease::RENEW`: one round trip instead of two. The writers' lock
-- is taken before the lock of the work item's row, as in all other statements.
-- $1 work item, $2 fencing token, $3 worker, $4 length of the lease [ms], $5 names of the blobs, a JSON array without repetitions, $6
-- duration of the reservation [ms].
-- Returns: number of reserved blobs, and true if a cancellation is requested, null if the lease is lost; nothing if single statements
-- are needed.
WITH reserved AS MATERIALIZED (
    SELECT count(*) AS blobs FROM reserve_blobs($5::json, $6)),
renewed AS (
    UPDATE work SET progress = 1, lease_until = now + $4, lease_ms = $4 FROM clock, reserved
    WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
    RETURNING cancel_requested)
SELECT blobs, cancel_requested FROM reserved LEFT JOIN renewed ON true

-- name: UNRESERVED
-- Blobs of a list without a valid reservation.
-- $1 their names, a JSON array.
-- A lookup for each blob: a join would scan all reservations.
SELECT value FROM json_array_elements_text($1::json) AS names (value)
WHERE coalesce((SELECT expires FROM upload WHERE blob = value), 0) <= (SELECT now FROM clock)
