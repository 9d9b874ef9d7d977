-- The table of a sweep: its points in order, a page.
-- $1 sweep, $2 the ordinal after which the page begins, $3 the most points.
-- Gives: ordinal, parameters, state, summary, error.
SELECT p.ordinal, p.parameters,
       CASE WHEN s.cancelled AND w.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE w.state END AS state,
       r.summary, w.error
FROM point p JOIN sweep s ON s.id = p.sweep_id JOIN work w ON w.key = p.work_key LEFT JOIN result r ON r.work_key = w.key
WHERE p.sweep_id = $1 AND p.ordinal > $2 AND NOT p.verifies
ORDER BY p.ordinal LIMIT $3
