-- name: RESERVE
-- Reserves blobs for rows to come, but those that are being deleted: they are not deleted until then. Who has reserved one for longer
-- keeps it (migrations/postgres/0001_schema.sql).
-- $1 their names, a JSON array without repetitions, $2 for how long [ms].
-- Gives: those that are reserved.
SELECT blob FROM reserve_blobs($1::json, $2) AS reserved (blob)

-- name: RESERVE_AT_ONCE
-- Reserves blobs for rows to come, as `RESERVE`, and extends a lease, as `lease::RENEW`, whose work is computed: one statement instead of two,
-- each a message to the server and back. The writers' lock is taken first, and the work item's row after it, as by everybody else.
-- $1 work item, $2 fencing token, $3 worker, $4 length of the lease [ms], $5 names of the blobs, a JSON array without repetitions, $6 for
-- how long they are reserved [ms].
-- Gives: how many blobs are reserved, and whether a cancellation is asked for, null if the lease is lost; nothing if it has to be done
-- step by step.
WITH reserved AS MATERIALIZED (
    SELECT count(*) AS blobs FROM reserve_blobs($5::json, $6)),
renewed AS (
    UPDATE work SET progress = 1, lease_until = now + $4, lease_ms = $4 FROM clock, reserved
    WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
    RETURNING cancel_requested)
SELECT blobs, cancel_requested FROM reserved LEFT JOIN renewed ON true

-- name: UNRESERVED
-- Those of some blobs that are not reserved, or not any more.
-- $1 their names, a JSON array.
-- Each is looked up by itself: as a join it would go through all reservations.
SELECT value FROM json_array_elements_text($1::json) AS names (value)
WHERE coalesce((SELECT expires FROM upload WHERE blob = value), 0) <= (SELECT now FROM clock)
