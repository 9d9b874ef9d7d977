-- name: ANALYZE
-- No operation: the plans do not depend on the number of rows.
SELECT 1 WHERE false

-- name: COPY_ARTIFACTS
-- Copies artifacts of results to copies of these results.
-- $1 keys of sources and targets, hexadecimal: a JSON array of pairs.
INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count, expired)
SELECT unhex(pair.value ->> 1), name, media_type, blob, bytes, row_count, expired
FROM json_each($1) AS pair
JOIN artifact ON work_key = unhex(pair.value ->> 0)
WHERE true
ON CONFLICT (work_key, name) DO NOTHING

-- name: COPY_RESULTS
-- Copies results of work items to other work items, as their earlier results.
-- $1 keys of sources and targets, hexadecimal: a JSON array of pairs.
INSERT INTO result (work_key, summary, provenance, created, disagrees, damaged)
SELECT unhex(pair.value ->> 1), summary, provenance, created, disagrees, damaged
FROM json_each($1) AS pair
JOIN result ON work_key = unhex(pair.value ->> 0)
WHERE true
ON CONFLICT (work_key) DO NOTHING

-- name: COUNT
-- Adds new points of a sweep, or new verification runs, to its counts; afterwards the counts follow the work.
-- $1 sweep, $2 their ordinals, a JSON array, $3 time, $4 true for runs.
UPDATE sweep SET (points_queued, points_running, points_done, points_failed, points_cancelled,
                  verifications, verifications_queued, verifications_running, verifications_done,
                  verifications_failed, verifications_cancelled, finished) = (
    SELECT points_queued + total(p.verifies = 0 AND w.stage = 'queued'),
           points_running + total(p.verifies = 0 AND w.stage = 'running'),
           points_done + total(p.verifies = 0 AND w.stage = 'done'),
           points_failed + total(p.verifies = 0 AND w.stage = 'failed'),
           points_cancelled + total(p.verifies = 0 AND w.stage = 'cancelled'),
           verifications + total(p.verifies),
           verifications_queued + total(p.verifies AND w.stage = 'queued'),
           verifications_running + total(p.verifies AND w.stage = 'running'),
           verifications_done + total(p.verifies AND w.stage = 'done'),
           verifications_failed + total(p.verifies AND w.stage = 'failed'),
           verifications_cancelled + total(p.verifies AND w.stage = 'cancelled'),
           CASE WHEN points_queued + points_running + verifications_queued + verifications_running
                     + total(w.is_open) = 0 THEN $3 END
    FROM point p JOIN work w ON w.key = p.work_key
    WHERE p.sweep_id = $1 AND p.verifies = $4 AND p.ordinal IN (SELECT value FROM json_each($2)))
WHERE id = $1

-- name: FULLER_RESULTS
-- Work items of a list that are done with an undamaged result and no expired artifact.
-- $1 their keys, a JSON array of hexadecimal strings.
SELECT key FROM work
WHERE key IN (SELECT unhex(value) FROM json_each($1))
  AND state = 'done'
  AND NOT EXISTS (SELECT 1 FROM result WHERE work_key = work.key AND damaged IS NOT NULL)
  AND NOT EXISTS (SELECT 1 FROM artifact WHERE work_key = work.key AND expired IS NOT NULL)

-- name: INSERT_POINTS
-- Stores points or verification runs of a sweep.
-- $1 sweep, $2 true for runs, $3 ordinals, keys of their work (hexadecimal) and parameters: a JSON array of triples.
INSERT INTO point (sweep_id, verifies, ordinal, parameters, work_key)
SELECT $1, $2, value ->> 0, value ->> 2, unhex(value ->> 1) FROM json_each($3)

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
INSERT INTO work (key, changes, vtime, base, physics_version, owner, state, held, priority, ready_at, created, changed)
SELECT unhex(value ->> 0), value ->> 1, $2 + $3 * (key + 1), $4, $5, $6, 'queued', $7, $8, $9, $9, $9
FROM json_each($1)
WHERE true
ON CONFLICT (key) DO UPDATE SET
    state = CASE WHEN is_open THEN state ELSE 'queued' END,
    changed = CASE WHEN is_open THEN changed ELSE excluded.changed END,
    owner = CASE WHEN is_open AND NOT (
                     state <> 'leased' AND owner <> excluded.owner AND held >= excluded.held
                     AND vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = work.owner AND o.is_open)
                         > excluded.vtime - $11)
                 THEN owner ELSE excluded.owner END,
    vtime = CASE WHEN is_open AND NOT (
                     state <> 'leased' AND owner <> excluded.owner AND held >= excluded.held
                     AND vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = work.owner AND o.is_open)
                         > excluded.vtime - $11)
                 THEN vtime ELSE excluded.vtime END,
    error = CASE WHEN is_open THEN error END,
    progress = CASE WHEN is_open THEN progress ELSE 0 END,
    checkpoint = CASE WHEN is_open OR NOT $10 THEN checkpoint END,
    crash_count = CASE WHEN is_open THEN crash_count ELSE 0 END,
    failure_count = CASE WHEN is_open THEN failure_count ELSE 0 END,
    priority = CASE WHEN is_open THEN max(priority, excluded.priority) ELSE excluded.priority END,
    cancel_requested = 0,
    held = CASE WHEN is_open THEN held AND excluded.held ELSE excluded.held END
WHERE CASE WHEN is_open
           THEN cancel_requested <> 0 OR held > excluded.held OR priority < excluded.priority
                OR (state <> 'leased' AND owner <> excluded.owner AND held >= excluded.held
                    AND vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = work.owner AND o.is_open)
                        > excluded.vtime - $11)
           ELSE state = 'cancelled' OR $10
                OR EXISTS (SELECT 1 FROM result WHERE work_key = work.key AND damaged IS NOT NULL)
      END

-- name: KNOWN_RESULTS
-- Number of work items of a list with an undamaged result.
-- $1 their keys, a JSON array of hexadecimal strings.
SELECT count(*) FROM result WHERE work_key IN (SELECT unhex(value) FROM json_each($1)) AND damaged IS NULL

-- name: KNOWN_WORK
-- Work items of a list that have a result or failed.
-- $1 their keys, a JSON array of hexadecimal strings.
SELECT key FROM work
WHERE key IN (SELECT unhex(value) FROM json_each($1))
  AND (stage = 'failed' OR EXISTS (SELECT 1 FROM result WHERE work_key = work.key))

-- name: OTHERS_RESULTS
-- Work items of a list that are done, failed or dead and belong to a sweep of another owner.
-- $1 their keys, a JSON array of hexadecimal strings; $2 the owner.
SELECT key FROM work
WHERE key IN (SELECT unhex(value) FROM json_each($1))
  AND state IN ('done', 'failed', 'dead')
  AND EXISTS (SELECT 1 FROM point JOIN sweep ON sweep.id = point.sweep_id
              WHERE point.work_key = work.key AND sweep.owner <> $2)

-- name: POINTS_OF
-- Work items of a list that belong to points of a sweep.
-- $1 sweep, $2 their keys, a JSON array of hexadecimal strings.
SELECT work_key FROM point
WHERE work_key IN (SELECT unhex(value) FROM json_each($2)) AND sweep_id = $1 AND verifies = 0
