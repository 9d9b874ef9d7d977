-- Takes work back whose lease has run out: a death of the worker, and the last that the work is given makes it dead. A
-- result from before stays, and the work is done then.
-- $1 deaths that make it dead.
-- Gives: new state, deaths, worker, what is known of it.
UPDATE work SET
    crash_count = crash_count + 1, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock),
    state = CASE WHEN NOT cancel_requested AND crash_count + 1 < $1 THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 WHEN cancel_requested THEN 'cancelled'
                 ELSE 'dead' END,
    error = CASE WHEN NOT cancel_requested AND crash_count + 1 >= $1
                 THEN json_build_object('class', 'crash', 'reason',
                      format('%s workers went silent while they simulated it', crash_count + 1)
                          || coalesce('; the last one ' || worker_note, ''))::text
                 ELSE error END
WHERE state = 'leased' AND lease_until < (SELECT now FROM clock)
RETURNING state, crash_count, lease_owner, worker_note
