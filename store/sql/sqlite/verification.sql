-- name: LIST
-- Verified points of a sweep, in order, with their verification runs.
-- $1 sweep.
-- Returns: ordinal, parameters, summary of the point, the run's key, state, error, summary.
-- CROSS JOIN fixes the order of the tables: verified points are few.
SELECT v.ordinal, p.parameters, of_point.summary, w.key,
       CASE WHEN s.cancelled <> 0 AND w.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE w.state END AS state,
       w.error, reference.summary
FROM point v
CROSS JOIN point p ON p.sweep_id = v.sweep_id AND p.verifies = 0 AND p.ordinal = v.ordinal
CROSS JOIN sweep s ON s.id = v.sweep_id
CROSS JOIN work w ON w.key = v.work_key
LEFT JOIN result of_point ON of_point.work_key = p.work_key
LEFT JOIN result reference ON reference.work_key = v.work_key
WHERE v.sweep_id = $1 AND v.verifies = 1
ORDER BY v.ordinal
