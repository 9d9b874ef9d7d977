-- A point with its scenario and result.
-- $1 sweep, $2 ordinal.
SELECT p.ordinal, p.parameters, w.key, base.text AS base, w.changes,
       CASE WHEN s.cancelled AND w.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE w.state END AS state,
       w.progress, w.attempts, w.error, r.summary, r.provenance
FROM point p JOIN sweep s ON s.id = p.sweep_id JOIN work w ON w.key = p.work_key
JOIN scenario base ON base.hash = w.base LEFT JOIN result r ON r.work_key = w.key
WHERE p.sweep_id = $1 AND NOT p.verifies AND p.ordinal = $2
