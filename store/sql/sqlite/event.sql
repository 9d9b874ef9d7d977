-- name: LIST
-- Events of a sweep, oldest first.
-- $1 sweep, $2 number after which they are, $3 how many at most.
-- Gives: number, new state, work item, time, ordinals of its points and of those that it verifies, by commas.
SELECT seq, kind, work_key, at,
       (SELECT group_concat(p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND p.verifies = 0),
       (SELECT group_concat(p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND p.verifies = 1)
FROM event
WHERE sweep_id = $1 AND seq > $2
ORDER BY seq LIMIT $3

-- name: MAKE_DURABLE
-- Nothing: what one process sees, a crash of another one does not undo.
SELECT 1 WHERE false

-- name: SWEEPS
-- Some sweeps, as lists have them: without their requests.
-- $1 the sweeps, a JSON array.
-- Running points are looked up from the few leased work items: an explicit order, since the planner cannot know that they
-- are few.
SELECT id, name, owner, '' AS request, priority, version, revision, cancelled, paused, pinned, expires, tags, created, finished,
       points, points_queued, points_running, points_done, points_failed, points_cancelled,
       verifications, verifications_queued, verifications_running, verifications_done, verifications_failed,
       verifications_cancelled,
       CASE points_running + verifications_running WHEN 0 THEN 0.0 ELSE (
           SELECT total(w.progress) FROM work w CROSS JOIN point p ON p.work_key = w.key
           WHERE w.state = 'leased' AND p.sweep_id = sweep.id
             AND (sweep.cancelled = 0 OR w.stage_of_cancelled = 'running')) END AS running_progress
FROM sweep
WHERE id IN (SELECT value FROM json_each($1)) AND hidden IS NULL
