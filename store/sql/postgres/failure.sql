-- name: LIST
-- Failed and dead points of all sweeps, latest first.
-- $1 time, $2 sweep, $3 ordinal of the point before the first, $4 owner or null, $5 class of error or null,
-- $6 largest number of rows.
-- The condition on the time alone is redundant; it lets the index of the failures apply.
SELECT s.id AS sweep_id, s.name AS sweep_name, s.owner, w.changed,
       p.ordinal, p.parameters, w.key, NULL::text AS base, NULL::text AS changes, w.state, w.progress, w.attempts,
       w.error, NULL::text AS summary, NULL::text AS provenance
FROM work w JOIN point p ON p.work_key = w.key JOIN sweep s ON s.id = p.sweep_id
WHERE w.stage = 'failed' AND NOT p.verifies AND w.changed <= $1 AND (w.changed, s.id, p.ordinal) < ($1, $2, $3)
  AND ($4 IS NULL OR s.owner = $4)
  AND ($5 IS NULL OR $5 = class_of_error(w.error))
ORDER BY w.changed DESC, s.id DESC, p.ordinal DESC LIMIT $6
