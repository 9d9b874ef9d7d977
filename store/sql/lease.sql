-- name: RENEW
-- Extends a lease and stores the progress.
-- $1 work item, $2 fencing token, $3 worker, $4 progress (0 to 1), $5 length of the lease [ms].
-- Returns: true if a cancellation is requested; nothing if the lease is lost.
UPDATE work SET progress = $4, lease_until = (SELECT now FROM clock) + $5, lease_ms = $5
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
RETURNING cancel_requested
