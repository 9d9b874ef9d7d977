-- Gives all work back that was leased where it comes from: it is queued, or cancelled where nobody wants it any more. A result from before
-- stays, and the work is done then.
UPDATE work SET
    state = CASE WHEN cancel_requested = 0 THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 ELSE 'cancelled' END,
    error = NULL, attempts = attempts - 1, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE state = 'leased'
