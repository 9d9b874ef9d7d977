-- The table of a sweep: its points in order.
-- ?1 sweep.
-- Gives: ordinal, parameters, state, summary, error.
SELECT p.ordinal, p.parameters, w.state, r.summary, w.error
FROM point p JOIN work w ON w.key = p.work_key LEFT JOIN result r ON r.work_key = w.key
WHERE p.sweep_id = ?1 AND p.verifies = 0
ORDER BY p.ordinal
