-- Ends a lease whose worker the work brought down in a way that it survived: a death of the worker, and the last that the
-- work is given makes it dead. A result from before stays, and the work is done then.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON, $5 deaths that make it dead.
UPDATE work SET
    crash_count = crash_count + 1, progress = 0, lease_until = NULL, error = $4, changed = (SELECT now FROM clock),
    state = CASE WHEN NOT cancel_requested AND crash_count + 1 < $5 THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 WHEN cancel_requested THEN 'cancelled'
                 ELSE 'dead' END
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
