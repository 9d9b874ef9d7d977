-- Ends a lease after the infrastructure failed: the work waits, twice as long as the time before and up to half as long
-- again by chance, and fails at the last try that it is given. A result from before stays, and the work is done then.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON, $5 tries, $6 least wait before the first retry [ms].
UPDATE work SET
    state = CASE WHEN NOT cancel_requested AND failure_count + 1 < $5 THEN 'waiting'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 WHEN cancel_requested THEN 'cancelled'
                 ELSE 'failed' END,
    ready_at = (SELECT now FROM clock) + ($6 << failure_count::int)
               + floor(random() * (($6 << failure_count::int) / 2 + 1))::bigint,
    failure_count = failure_count + 1,
    error = $4, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
