-- name: LIST
-- Points of a sweep in order, without scenarios and results.
-- $1 sweep, $2 ordinal before the first point, $3 states of their work (JSON array), or null for all, $4 largest number of rows.
SELECT p.ordinal, p.parameters, w.key, NULL::text AS base, NULL::text AS changes,
       CASE WHEN s.cancelled AND w.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE w.state END AS state,
       w.progress, w.attempts, w.error, NULL::text AS summary, NULL::text AS provenance
FROM point p JOIN sweep s ON s.id = p.sweep_id JOIN work w ON w.key = p.work_key
WHERE p.sweep_id = $1 AND NOT p.verifies AND p.ordinal > $2
  AND ($3 IS NULL
       OR CASE WHEN s.cancelled AND w.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE w.state END
          IN (SELECT json_array_elements_text($3::json)))
ORDER BY p.ordinal LIMIT $4
