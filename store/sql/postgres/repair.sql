-- name: QUEUE
-- Queues a done work item again. It is held while all live sweeps with it are paused.
-- $1 work item, $2 its position in its owner's order.
UPDATE work SET
    state = 'queued', changed = (SELECT now FROM clock), vtime = $2, ready_at = (SELECT now FROM clock),
    error = NULL, progress = 0, checkpoint = NULL, crash_count = 0, failure_count = 0, cancel_requested = false,
    held = (SELECT coalesce(bool_and(s.paused), false) FROM point p JOIN sweep s ON s.id = p.sweep_id
            WHERE p.work_key = work.key AND NOT s.cancelled)
WHERE key = $1 AND state = 'done'
