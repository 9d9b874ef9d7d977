-- name: ARTIFACTS
-- Artifacts of a result, by name.
-- $1 work item.
SELECT name, media_type, blob, bytes, row_count, expired FROM artifact WHERE work_key = $1 ORDER BY name

-- name: ONE
-- Point with its scenario and result.
-- $1 sweep, $2 ordinal.
SELECT p.ordinal, p.parameters, w.key, base.text AS base, w.changes,
       CASE WHEN s.cancelled AND w.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE w.state END AS state,
       w.progress, w.attempts, w.error, r.summary, r.provenance
FROM point p JOIN sweep s ON s.id = p.sweep_id JOIN work w ON w.key = p.work_key
JOIN scenario base ON base.hash = w.base LEFT JOIN result r ON r.work_key = w.key
WHERE p.sweep_id = $1 AND p.verifies = false AND p.ordinal = $2

-- name: TABLE
-- Page of a sweep's table: its points in order.
-- $1 sweep, $2 ordinal before the page, $3 largest number of points.
-- Returns: ordinal, parameters, state, summary, error.
SELECT p.ordinal, p.parameters,
       CASE WHEN s.cancelled AND w.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE w.state END AS state,
       r.summary, w.error
FROM point p JOIN sweep s ON s.id = p.sweep_id JOIN work w ON w.key = p.work_key LEFT JOIN result r ON r.work_key = w.key
WHERE p.sweep_id = $1 AND p.ordinal > $2 AND p.verifies = false
ORDER BY p.ordinal LIMIT $3

-- name: WITH_ARTIFACTS
-- Artifacts of points of a sweep, by point and name.
-- $1 sweep, $2 ordinal before the first point, $3 largest number of points.
SELECT p.ordinal, p.work_key, a.name, a.media_type, a.blob, a.bytes, a.row_count, a.expired
FROM (SELECT ordinal, work_key FROM point
      WHERE sweep_id = $1 AND verifies = false AND ordinal > $2
        AND EXISTS (SELECT 1 FROM artifact WHERE artifact.work_key = point.work_key)
      ORDER BY ordinal LIMIT $3) AS p
JOIN artifact a ON a.work_key = p.work_key
ORDER BY p.ordinal, a.name
