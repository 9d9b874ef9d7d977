-- name: LIST
-- Failed and dead points of all sweeps, latest first.
-- $1 time, $2 sweep, $3 ordinal of the point before the first, $4 owner or null, $5 class of error or null,
-- $6 largest number of rows.
-- CROSS JOIN fixes the order of the tables: failures are few, and the index returns them in this order. An error that is not JSON has no
-- class.
SELECT s.id AS sweep_id, s.name AS sweep_name, s.owner, w.changed,
       p.ordinal, p.parameters, w.key, NULL AS base, NULL AS changes, w.state, w.progress, w.attempts,
       w.error, NULL AS summary, NULL AS provenance
FROM work w CROSS JOIN point p ON p.work_key = w.key CROSS JOIN sweep s ON s.id = p.sweep_id
WHERE w.stage = 'failed' AND p.verifies = 0 AND w.changed <= $1 AND (w.changed, s.id, p.ordinal) < ($1, $2, $3)
  AND ($4 IS NULL OR s.owner = $4)
  AND ($5 IS NULL OR $5 = CASE WHEN json_valid(w.error) THEN json_extract(w.error, '$.class') END)
ORDER BY w.changed DESC, s.id DESC, p.ordinal DESC LIMIT $6
