-- Counts all points of a sweep that is not cancelled any more, and the runs that verify them.
-- $1 sweep.
UPDATE sweep SET (points_queued, points_running, points_done, points_failed, points_cancelled,
                  verifications_queued, verifications_running, verifications_done, verifications_failed,
                  verifications_cancelled, finished) = (
    SELECT count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'queued'),
           count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'running'),
           count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'done'),
           count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'failed'),
           count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'cancelled'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'queued'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'running'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'done'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'failed'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'cancelled'),
           CASE WHEN count(*) FILTER (WHERE w.is_open) = 0 THEN finished END
    FROM point p JOIN work w ON w.key = p.work_key
    WHERE p.sweep_id = $1)
WHERE id = $1
