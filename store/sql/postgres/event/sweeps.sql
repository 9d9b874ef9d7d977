-- Some sweeps, as lists have them: without their requests.
-- $1 the sweeps, a JSON array.
SELECT id, name, owner, '' AS request, priority, version, revision, cancelled, paused, pinned, expires, tags, created, finished,
       points, points_queued, points_running, points_done, points_failed, points_cancelled,
       verifications, verifications_queued, verifications_running, verifications_done, verifications_failed,
       verifications_cancelled,
       CASE points_running + verifications_running WHEN 0 THEN 0.0 ELSE (
           SELECT coalesce(sum(w.progress), 0.0) FROM work w JOIN point p ON p.work_key = w.key
           WHERE w.state = 'leased' AND p.sweep_id = sweep.id
             AND (NOT sweep.cancelled OR w.stage_of_cancelled = 'running')) END AS running_progress
FROM sweep
WHERE id IN (SELECT value FROM json_array_elements_text($1::json)) AND hidden IS NULL
