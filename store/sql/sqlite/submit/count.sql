-- Counts the points of a sweep that are new, or the runs that verify points; from then on the counts follow the work.
-- ?1 sweep, ?2 their ordinals, a JSON array, ?3 time, ?4 whether they are runs.
UPDATE sweep SET (points_queued, points_running, points_done, points_failed, points_cancelled,
                  verifications, verifications_queued, verifications_running, verifications_done,
                  verifications_failed, verifications_cancelled, finished) = (
    SELECT points_queued + total(p.verifies = 0 AND w.stage = 'queued'),
           points_running + total(p.verifies = 0 AND w.stage = 'running'),
           points_done + total(p.verifies = 0 AND w.stage = 'done'),
           points_failed + total(p.verifies = 0 AND w.stage = 'failed'),
           points_cancelled + total(p.verifies = 0 AND w.stage = 'cancelled'),
           verifications + total(p.verifies),
           verifications_queued + total(p.verifies AND w.stage = 'queued'),
           verifications_running + total(p.verifies AND w.stage = 'running'),
           verifications_done + total(p.verifies AND w.stage = 'done'),
           verifications_failed + total(p.verifies AND w.stage = 'failed'),
           verifications_cancelled + total(p.verifies AND w.stage = 'cancelled'),
           CASE WHEN points_queued + points_running + verifications_queued + verifications_running
                     + total(w.is_open) = 0 THEN ?3 END
    FROM point p JOIN work w ON w.key = p.work_key
    WHERE p.sweep_id = ?1 AND p.verifies = ?4 AND p.ordinal IN (SELECT value FROM json_each(?2)))
WHERE id = ?1
