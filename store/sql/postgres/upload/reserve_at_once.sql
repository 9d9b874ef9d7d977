-- Reserves blobs for rows to come, as `reserve`, and extends a lease, as `queue/renew`, whose work is computed: one statement instead of two,
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
