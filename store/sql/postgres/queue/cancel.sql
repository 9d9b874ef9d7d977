-- Ends a lease whose work nobody wants any more; where it was asked for again since the worker's last renewal, the work is
-- queued. A result from before stays, and the work is done then.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON.
UPDATE work SET
    state = CASE WHEN NOT cancel_requested THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 ELSE 'cancelled' END,
    error = CASE WHEN NOT cancel_requested OR EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN NULL
                 ELSE $4 END,
    progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
