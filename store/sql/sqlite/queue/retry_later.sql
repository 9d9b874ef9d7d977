-- Ends a lease after the infrastructure failed: the work waits, twice as long as the time before and up to half as long
-- again by chance, and fails at the last try that it is given. A result from before stays, and the work is done then.
-- ?1 work item, ?2 fencing token, ?3 worker, ?4 error, JSON, ?5 tries, ?6 least wait before the first retry [ms].
-- Of the random number the bits without the sign's: the absolute value of the least integer is none.
UPDATE work SET
    state = CASE WHEN cancel_requested = 0 AND failure_count + 1 < ?5 THEN 'waiting'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 WHEN cancel_requested <> 0 THEN 'cancelled'
                 ELSE 'failed' END,
    ready_at = (SELECT now FROM clock) + (?6 << failure_count)
               + (random() & 0x7fffffffffffffff) % ((?6 << failure_count) / 2 + 1),
    failure_count = failure_count + 1,
    error = ?4, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = ?1 AND fencing_token = ?2 AND lease_owner = ?3 AND state = 'leased'
