-- The table of a sweep: its points in order.
-- $1 sweep.
-- Gives: ordinal, parameters, state, summary, error.
SELECT p.ordinal, p.parameters,
       CASE WHEN s.cancelled AND w.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE w.state END AS state,
       r.summary, w.error
FROM point p JOIN sweep s ON s.id = p.sweep_id JOIN work w ON w.key = p.work_key LEFT JOIN result r ON r.work_key = w.key
WHERE p.sweep_id = $1 AND NOT p.verifies
ORDER BY p.ordinal
