-- name: ANALYZE
-- Updates the planner's statistics: until then it takes tables that have just grown for small ones, and sorts rows that it could read in
-- order.
ANALYZE point, work

-- name: COPY_ARTIFACTS
-- Copies artifacts of results to copies of these results.
-- $1 keys of sources and targets, hexadecimal: a JSON array of pairs.
INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count, expired)
SELECT decode(pair ->> 1, 'hex'), name, media_type, blob, bytes, row_count, expired
FROM json_array_elements($1::json) AS pair JOIN artifact ON work_key = decode(pair ->> 0, 'hex')
ON CONFLICT (work_key, name) DO NOTHING

-- name: COPY_RESULTS
-- Copies results of work items to other work items, as their earlier results.
-- $1 keys of sources and targets, hexadecimal: a JSON array of pairs.
INSERT INTO result (work_key, summary, provenance, created, disagrees, damaged)
SELECT decode(pair ->> 1, 'hex'), summary, provenance, created, disagrees, damaged
FROM json_array_elements($1::json) AS pair JOIN result ON work_key = decode(pair ->> 0, 'hex')
ON CONFLICT (work_key) DO NOTHING

-- name: COUNT
-- Adds new points of a sweep, or new verification runs, to its counts; afterwards the counts follow the work.
-- $1 sweep, $2 their ordinals, a JSON array, $3 time, $4 true for runs.
-- A lookup for each point, independent of the planner's statistics of tables that have just grown.
UPDATE sweep SET (points_queued, points_running, points_done, points_failed, points_cancelled,
                  verifications, verifications_queued, verifications_running, verifications_done,
                  verifications_failed, verifications_cancelled, finished) = (
    SELECT points_queued + count(*) FILTER (WHERE NOT $4 AND w.stage = 'queued'),
           points_running + count(*) FILTER (WHERE NOT $4 AND w.stage = 'running'),
           points_done + count(*) FILTER (WHERE NOT $4 AND w.stage = 'done'),
           points_failed + count(*) FILTER (WHERE NOT $4 AND w.stage = 'failed'),
           points_cancelled + count(*) FILTER (WHERE NOT $4 AND w.stage = 'cancelled'),
           verifications + count(*) FILTER (WHERE $4),
           verifications_queued + count(*) FILTER (WHERE $4 AND w.stage = 'queued'),
           verifications_running + count(*) FILTER (WHERE $4 AND w.stage = 'running'),
           verifications_done + count(*) FILTER (WHERE $4 AND w.stage = 'done'),
           verifications_failed + count(*) FILTER (WHERE $4 AND w.stage = 'failed'),
           verifications_cancelled + count(*) FILTER (WHERE $4 AND w.stage = 'cancelled'),
           CASE WHEN points_queued + points_running + verifications_queued + verifications_running
                     + count(*) FILTER (WHERE w.is_open) = 0 THEN $3::bigint END
    FROM json_array_elements_text($2::json) AS new (ordinal)
    CROSS JOIN LATERAL (
        SELECT stage, is_open FROM point p JOIN work ON key = p.work_key
        WHERE p.sweep_id = $1 AND p.verifies = $4 AND p.ordinal = new.ordinal::bigint LIMIT 1) AS w)
WHERE id = $1

-- name: FULLER_RESULTS
-- Work items of a list that are done with an undamaged result and no expired artifact.
-- $1 their keys, a JSON array of hexadecimal strings.
SELECT key FROM work
WHERE key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($1::json))
  AND state = 'done'
  AND NOT EXISTS (SELECT 1 FROM result WHERE work_key = work.key AND damaged IS NOT NULL)
  AND NOT EXISTS (SELECT 1 FROM artifact WHERE work_key = work.key AND expired IS NOT NULL)

-- name: INSERT_POINTS
-- Stores points or verification runs of a sweep.
-- $1 sweep, $2 true for runs, $3 ordinals, keys of their work (hexadecimal) and parameters: a JSON array of triples.
INSERT INTO point (sweep_id, verifies, ordinal, parameters, work_key)
SELECT $1, $2, (value ->> 0)::bigint, value ->> 2, decode(value ->> 1, 'hex') FROM json_array_elements($3::json) AS rows (value)

-- name: INSERT_WORK
-- Stores work items at consecutive positions.
-- $1 their keys (hexadecimal) and changes: a JSON array of pairs; $2 position before the first, $3 distance of positions, $4 base, $5
-- physics version, $6 owner, $7 true if held, $8 priority, $9 time, $10 true if final ones are recomputed, $11 first position taken in
-- the owner's order.
--
-- Existing final work is queued like new work if it was cancelled, has a damaged result, or is to be recomputed. Existing open work
-- takes the higher priority, loses a requested cancellation, stays held only if both are held, and, unless leased or held by this
-- request alone, moves to the owner in whose order it is nearer to the front: otherwise a few points would wait for a whole sweep of
-- another owner that has them too. The last condition leaves all other rows unchanged.
--
-- Duplicates are stored at the position of the first: a statement can change a row only once.
INSERT INTO work AS w (key, changes, vtime, base, physics_version, owner, state, held, priority, ready_at, created, changed)
SELECT DISTINCT ON (key) key, changes, $2 + $3 * number, $4, $5, $6, 'queued', $7, $8, $9, $9, $9
FROM (SELECT decode(value ->> 0, 'hex') AS key, value ->> 1 AS changes, number
      FROM json_array_elements($1::json) WITH ORDINALITY AS rows (value, number)) AS new
ORDER BY key, number
ON CONFLICT (key) DO UPDATE SET
    state = CASE WHEN w.is_open THEN w.state ELSE 'queued' END,
    changed = CASE WHEN w.is_open THEN w.changed ELSE excluded.changed END,
    owner = CASE WHEN w.is_open AND NOT (
                     w.state <> 'leased' AND w.owner <> excluded.owner AND w.held >= excluded.held
                     AND w.vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = w.owner AND o.is_open)
                         > excluded.vtime - $11)
                 THEN w.owner ELSE excluded.owner END,
    vtime = CASE WHEN w.is_open AND NOT (
                     w.state <> 'leased' AND w.owner <> excluded.owner AND w.held >= excluded.held
                     AND w.vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = w.owner AND o.is_open)
                         > excluded.vtime - $11)
                 THEN w.vtime ELSE excluded.vtime END,
    error = CASE WHEN w.is_open THEN w.error END,
    progress = CASE WHEN w.is_open THEN w.progress ELSE 0 END,
    checkpoint = CASE WHEN w.is_open OR NOT $10 THEN w.checkpoint END,
    crash_count = CASE WHEN w.is_open THEN w.crash_count ELSE 0 END,
    failure_count = CASE WHEN w.is_open THEN w.failure_count ELSE 0 END,
    priority = CASE WHEN w.is_open THEN greatest(w.priority, excluded.priority) ELSE excluded.priority END,
    cancel_requested = false,
    held = CASE WHEN w.is_open THEN w.held AND excluded.held ELSE excluded.held END
WHERE CASE WHEN w.is_open
           THEN w.cancel_requested OR w.held > excluded.held OR w.priority < excluded.priority
                OR (
                     w.state <> 'leased' AND w.owner <> excluded.owner AND w.held >= excluded.held
                     AND w.vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = w.owner AND o.is_open)
                         > excluded.vtime - $11)
           ELSE w.state = 'cancelled' OR $10
                OR EXISTS (SELECT 1 FROM result WHERE work_key = w.key AND damaged IS NOT NULL)
      END

-- name: KNOWN_RESULTS
-- Number of work items of a list with an undamaged result.
-- $1 their keys, a JSON array of hexadecimal strings.
SELECT count(*) FROM result WHERE work_key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($1::json)) AND damaged IS NULL

-- name: KNOWN_WORK
-- Work items of a list that have a result or failed.
-- $1 their keys, a JSON array of hexadecimal strings.
SELECT key FROM work
WHERE key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($1::json))
  AND (stage = 'failed' OR EXISTS (SELECT 1 FROM result WHERE work_key = work.key))

-- name: OTHERS_RESULTS
-- Work items of a list that are done, failed or dead and belong to a sweep of another owner.
-- $1 their keys, a JSON array of hexadecimal strings; $2 the owner.
SELECT key FROM work
WHERE key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($1::json))
  AND state IN ('done', 'failed', 'dead')
  AND EXISTS (SELECT 1 FROM point JOIN sweep ON sweep.id = point.sweep_id
              WHERE point.work_key = work.key AND sweep.owner <> $2)

-- name: POINTS_OF
-- Work items of a list that belong to points of a sweep.
-- $1 sweep, $2 their keys, a JSON array of hexadecimal strings.
SELECT work_key FROM point
WHERE work_key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($2::json)) AND sweep_id = $1 AND NOT verifies
