-- name: LAST_POINT
-- Ordinal of the last point of a sweep, or of the last that a run verifies; 0 without any.
-- $1 sweep.
SELECT max(coalesce((SELECT max(ordinal) FROM point WHERE sweep_id = $1 AND verifies = 0), 0),
           coalesce((SELECT max(ordinal) FROM point WHERE sweep_id = $1 AND verifies = 1), 0))

-- name: LIST
-- Sweeps, newest first; a null filter matches all.
-- $1 owner, $2 last sweep of the previous page, $3 largest number of rows, $4 state, $5 part of the name, $6 tag, $7 beginning
-- of the identifier.
-- CROSS JOIN starts from the leased work items: the planner cannot know that they are few.
SELECT id, name, owner, varied, priority, version, revision, cancelled, paused, pinned, expires, tags, created, finished,
       points, points_queued, points_running, points_done, points_failed, points_cancelled,
       verifications, verifications_queued, verifications_running, verifications_done, verifications_failed,
       verifications_cancelled,
       CASE points_running + verifications_running WHEN 0 THEN 0.0 ELSE (
           SELECT total(w.progress) FROM work w CROSS JOIN point p ON p.work_key = w.key
           WHERE w.state = 'leased' AND p.sweep_id = sweep.id
             AND (sweep.cancelled = 0 OR w.stage_of_cancelled = 'running')) END AS running_progress
FROM sweep
WHERE hidden IS NULL AND ($1 IS NULL OR owner = $1) AND ($2 IS NULL OR id < $2)
  AND ($4 IS NULL OR $4 = CASE WHEN cancelled <> 0 THEN 'cancelled'
                               WHEN finished IS NOT NULL THEN 'completed'
                               WHEN paused <> 0 THEN 'paused'
                               ELSE 'running' END)
  AND ($5 IS NULL OR instr(lower(name), lower($5)) > 0)
  AND ($6 IS NULL OR EXISTS (SELECT 1 FROM json_each(tags) WHERE value = $6))
  AND ($7 IS NULL OR substr(id, 1, length($7)) = lower($7))
ORDER BY id DESC LIMIT $3

-- name: ONE
-- A sweep.
-- $1 sweep.
-- CROSS JOIN starts from the leased work items: the planner cannot know that they are few.
SELECT id, name, owner, varied, priority, version, revision, cancelled, paused, pinned, expires, tags, created, finished,
       points, points_queued, points_running, points_done, points_failed, points_cancelled,
       verifications, verifications_queued, verifications_running, verifications_done, verifications_failed,
       verifications_cancelled,
       CASE points_running + verifications_running WHEN 0 THEN 0.0 ELSE (
           SELECT total(w.progress) FROM work w CROSS JOIN point p ON p.work_key = w.key
           WHERE w.state = 'leased' AND p.sweep_id = sweep.id
             AND (sweep.cancelled = 0 OR w.stage_of_cancelled = 'running')) END AS running_progress
FROM sweep
WHERE id = $1 AND hidden IS NULL

-- name: PHYSICS_VERSIONS
-- Physics versions of some sweeps: those of their first points, since all points of a sweep have the same.
-- $1 the sweeps, a JSON array.
-- Returns: sweep, version; nothing for missing sweeps.
SELECT id, physics_version FROM (
    SELECT value AS id,
           (SELECT w.physics_version FROM point p JOIN work w ON w.key = p.work_key
            WHERE p.sweep_id = json_each.value AND p.verifies = 0 ORDER BY p.ordinal LIMIT 1) AS physics_version
    FROM json_each($1))
WHERE physics_version IS NOT NULL

-- name: RETRY_WORK
-- Queues the failed and cancelled work of a sweep in the order of its points, verification runs last.
-- $1 sweep, $2 owner, $3 position before the first, $4 distance of positions.
UPDATE work SET
    state = 'queued', changed = (SELECT now FROM clock), owner = $2, vtime = $3 + $4 * turn.number,
    error = NULL, progress = 0, crash_count = 0, failure_count = 0, cancel_requested = 0
FROM (SELECT p.work_key AS key, row_number() OVER (ORDER BY min(p.verifies), min(p.ordinal)) AS number
      FROM point p JOIN work w ON w.key = p.work_key
      WHERE p.sweep_id = $1 AND w.stage IN ('failed', 'cancelled')
      GROUP BY p.work_key) AS turn
WHERE work.key = turn.key
