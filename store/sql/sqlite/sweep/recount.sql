-- Counts all points of a sweep that is not cancelled any more, and the runs that verify them.
-- ?1 sweep.
UPDATE sweep SET (points_queued, points_running, points_done, points_failed, points_cancelled,
                  verifications_queued, verifications_running, verifications_done, verifications_failed,
                  verifications_cancelled, finished) = (
    SELECT total(p.verifies = 0 AND w.stage = 'queued'), total(p.verifies = 0 AND w.stage = 'running'),
           total(p.verifies = 0 AND w.stage = 'done'), total(p.verifies = 0 AND w.stage = 'failed'),
           total(p.verifies = 0 AND w.stage = 'cancelled'),
           total(p.verifies AND w.stage = 'queued'), total(p.verifies AND w.stage = 'running'),
           total(p.verifies AND w.stage = 'done'), total(p.verifies AND w.stage = 'failed'),
           total(p.verifies AND w.stage = 'cancelled'),
           CASE WHEN total(w.is_open) = 0 THEN finished END
    FROM point p JOIN work w ON w.key = p.work_key
    WHERE p.sweep_id = ?1)
WHERE id = ?1
