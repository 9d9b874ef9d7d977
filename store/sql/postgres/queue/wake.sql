-- Queues retries that are due, and those that would wait longer than they could, had they begun now.
-- $1 longest wait of a retry [ms].
UPDATE work SET state = 'queued', changed = (SELECT now FROM clock)
WHERE state = 'waiting'
  AND (ready_at <= (SELECT now FROM clock) OR ready_at > (SELECT now FROM clock) + $1)
