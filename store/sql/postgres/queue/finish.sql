-- Ends a lease with a result.
-- $1 work item, $2 fencing token, $3 worker.
-- Gives: the time; nothing if the lease is lost.
UPDATE work SET
    state = 'done', progress = 1, error = NULL, checkpoint = NULL, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
RETURNING changed
