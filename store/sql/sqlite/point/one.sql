-- A point with its scenario and result.
-- ?1 sweep, ?2 ordinal.
SELECT p.ordinal, p.parameters, w.key, s.text AS base, w.changes, w.state, w.progress, w.attempts, w.error,
       r.summary, r.provenance
FROM point p JOIN work w ON w.key = p.work_key JOIN scenario s ON s.hash = w.base LEFT JOIN result r ON r.work_key = w.key
WHERE p.sweep_id = ?1 AND p.verifies = 0 AND p.ordinal = ?2
