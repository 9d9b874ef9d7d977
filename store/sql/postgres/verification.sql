-- name: LIST
-- Verified points of a sweep, in order, with their verification runs.
-- $1 sweep.
-- Returns: ordinal, parameters, summary of the point, the run's key, state, error, summary.
SELECT v.ordinal, p.parameters, of_point.summary, w.key,
       CASE WHEN s.cancelled AND w.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE w.state END AS state,
       w.error, reference.summary
FROM point v
JOIN point p ON p.sweep_id = v.sweep_id AND NOT p.verifies AND p.ordinal = v.ordinal
JOIN sweep s ON s.id = v.sweep_id
JOIN work w ON w.key = v.work_key
LEFT JOIN result of_point ON of_point.work_key = p.work_key
LEFT JOIN result reference ON reference.work_key = v.work_key
WHERE v.sweep_id = $1 AND v.verifies
ORDER BY v.ordinal
