-- Ends a lease without a result, for good. A result from before stays, and the work is done then.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON.
UPDATE work SET
    state = CASE WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done' ELSE 'failed' END,
    error = $4, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
