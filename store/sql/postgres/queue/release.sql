-- Ends a lease whose work is given back untried: it is queued, or cancelled where nobody wants it any more. A result from
-- before stays, and the work is done then.
-- $1 work item, $2 fencing token, $3 worker.
UPDATE work SET
    state = CASE WHEN NOT cancel_requested THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 ELSE 'cancelled' END,
    error = NULL, attempts = attempts - 1, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
