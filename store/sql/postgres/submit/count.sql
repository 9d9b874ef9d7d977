-- Counts the points of a sweep that are new, or the runs that verify points; from then on the counts follow the work.
-- $1 sweep, $2 their ordinals, a JSON array, $3 time, $4 whether they are runs.
-- Each is looked up by itself, whatever the planner thinks of tables that have just grown.
UPDATE sweep SET (points_queued, points_running, points_done, points_failed, points_cancelled,
                  verifications, verifications_queued, verifications_running, verifications_done,
                  verifications_failed, verifications_cancelled, finished) = (
    SELECT points_queued + count(*) FILTER (WHERE NOT $4 AND w.stage = 'queued'),
           points_running + count(*) FILTER (WHERE NOT $4 AND w.stage = 'running'),
           points_done + count(*) FILTER (WHERE NOT $4 AND w.stage = 'done'),
           points_failed + count(*) FILTER (WHERE NOT $4 AND w.stage = 'failed'),
           points_cancelled + count(*) FILTER (WHERE NOT $4 AND w.stage = 'cancelled'),
           verifications + count(*) FILTER (WHERE $4),
           verifications_queued + count(*) FILTER (WHERE $4 AND w.stage = 'queued'),
           verifications_running + count(*) FILTER (WHERE $4 AND w.stage = 'running'),
           verifications_done + count(*) FILTER (WHERE $4 AND w.stage = 'done'),
           verifications_failed + count(*) FILTER (WHERE $4 AND w.stage = 'failed'),
           verifications_cancelled + count(*) FILTER (WHERE $4 AND w.stage = 'cancelled'),
           CASE WHEN points_queued + points_running + verifications_queued + verifications_running
                     + count(*) FILTER (WHERE w.is_open) = 0 THEN $3::bigint END
    FROM json_array_elements_text($2::json) AS new (ordinal)
    CROSS JOIN LATERAL (
        SELECT stage, is_open FROM point p JOIN work ON key = p.work_key
        WHERE p.sweep_id = $1 AND p.verifies = $4 AND p.ordinal = new.ordinal::bigint LIMIT 1) AS w)
WHERE id = $1
