-- Queues the work of a sweep that failed or was cancelled, in the order of its points, the runs that verify them last.
-- $1 sweep, $2 owner, $3 the place before the first, $4 distance of the places.
UPDATE work SET
    state = 'queued', changed = (SELECT now FROM clock), owner = $2, vtime = $3 + $4 * turn.number,
    error = NULL, progress = 0, crash_count = 0, failure_count = 0, cancel_requested = false
FROM (SELECT p.work_key AS key, row_number() OVER (ORDER BY bool_and(p.verifies), min(p.ordinal)) AS number
      FROM point p JOIN work w ON w.key = p.work_key
      WHERE p.sweep_id = $1 AND w.stage IN ('failed', 'cancelled')
      GROUP BY p.work_key) AS turn
WHERE work.key = turn.key
