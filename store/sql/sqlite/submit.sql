-- name: ANALYZE
-- Nothing: the plans are the same however much there is.
SELECT 1 WHERE false

-- name: COPY_ARTIFACTS
-- Gives results that were copied the tables of those that they were copied from.
-- $1 keys of those and of these, hexadecimal digits: a JSON array of pairs.
INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count, expired)
SELECT unhex(pair.value ->> 1), name, media_type, blob, bytes, row_count, expired
FROM json_each($1) AS pair
JOIN artifact ON work_key = unhex(pair.value ->> 0)
WHERE true
ON CONFLICT (work_key, name) DO NOTHING

-- name: COPY_RESULTS
-- Gives work items the results of others, which theirs are to take the place of.
-- $1 keys of those and of these, hexadecimal digits: a JSON array of pairs.
INSERT INTO result (work_key, summary, provenance, created, disagrees, damaged)
SELECT unhex(pair.value ->> 1), summary, provenance, created, disagrees, damaged
FROM json_each($1) AS pair
JOIN result ON work_key = unhex(pair.value ->> 0)
WHERE true
ON CONFLICT (work_key) DO NOTHING

-- name: COUNT
-- Counts the points of a sweep that are new, or the runs that verify points; from then on the counts follow the work.
-- $1 sweep, $2 their ordinals, a JSON array, $3 time, $4 whether they are runs.
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
-- Those of some work items that have a result with all its tables, and are not being recomputed.
-- $1 their keys, a JSON array of hexadecimal digits.
SELECT key FROM work
WHERE key IN (SELECT unhex(value) FROM json_each($1))
  AND state = 'done'
  AND NOT EXISTS (SELECT 1 FROM result WHERE work_key = work.key AND damaged IS NOT NULL)
  AND NOT EXISTS (SELECT 1 FROM artifact WHERE work_key = work.key AND expired IS NOT NULL)

-- name: INSERT_POINTS
-- Stores points of a sweep, or runs that verify some.
-- $1 sweep, $2 whether they are runs, $3 ordinals, keys of their work, hexadecimal digits, and parameters: a JSON array of
-- triples.
INSERT INTO point (sweep_id, verifies, ordinal, parameters, work_key)
SELECT $1, $2, value ->> 0, value ->> 2, unhex(value ->> 1) FROM json_each($3)

-- name: INSERT_WORK
-- Stores work items, each a place after the one before.
-- $1 their keys, hexadecimal digits, and changes: a JSON array of pairs; $2 the place before the first, $3 distance of the
-- places, $4 base, $5 version of the numbers, $6 owner, $7 whether they are held, $8 priority, $9 time, $10 whether those
-- that are final are recomputed, $11 first place that is taken in the owner's order.
--
-- What becomes of work that is there: what was cancelled, has a damaged result, or is to be recomputed, is taken up again as if it were new.
-- What is open goes as early as the most urgent sweep that wants it, is neither cancelled nor held any more, and becomes a
-- turn of the owner in whose order it stands nearer to the front: else a few points would wait for all of somebody else's
-- sweep that has them too. All else stays as it is, by the last condition: where a row is changed and is not open, it is
-- taken up again.
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
-- Counts those of some work items that have a result which is not damaged.
-- $1 their keys, a JSON array of hexadecimal digits.
SELECT count(*) FROM result WHERE work_key IN (SELECT unhex(value) FROM json_each($1)) AND damaged IS NULL

-- name: KNOWN_WORK
-- Those of some work items that have a result or failed.
-- $1 their keys, a JSON array of hexadecimal digits.
SELECT key FROM work
WHERE key IN (SELECT unhex(value) FROM json_each($1))
  AND (stage = 'failed' OR EXISTS (SELECT 1 FROM result WHERE work_key = work.key))

-- name: OTHERS_RESULTS
-- Those of some work items that are final and that sweeps of other owners have.
-- $1 their keys, a JSON array of hexadecimal digits; $2 the owner.
SELECT key FROM work
WHERE key IN (SELECT unhex(value) FROM json_each($1))
  AND state IN ('done', 'failed', 'dead')
  AND EXISTS (SELECT 1 FROM point JOIN sweep ON sweep.id = point.sweep_id
              WHERE point.work_key = work.key AND sweep.owner <> $2)

-- name: POINTS_OF
-- Those of some work items that a sweep has among its points.
-- $1 sweep, $2 their keys, a JSON array of hexadecimal digits.
SELECT work_key FROM point
WHERE work_key IN (SELECT unhex(value) FROM json_each($2)) AND sweep_id = $1 AND verifies = 0
