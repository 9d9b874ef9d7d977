-- Sweeps, newest first; what is none lets all through.
-- $1 owner, $2 sweep before which they are, $3 how many at most, $4 state, $5 part of the name, $6 tag, $7 what the identifier begins with.
SELECT id, name, owner, request, priority, version, revision, cancelled, paused, pinned, expires, tags, created, finished,
       points, points_queued, points_running, points_done, points_failed, points_cancelled,
       verifications, verifications_queued, verifications_running, verifications_done, verifications_failed,
       verifications_cancelled,
       CASE points_running + verifications_running WHEN 0 THEN 0.0 ELSE (
           SELECT coalesce(sum(w.progress), 0.0) FROM work w JOIN point p ON p.work_key = w.key
           WHERE w.state = 'leased' AND p.sweep_id = sweep.id
             AND (NOT sweep.cancelled OR w.stage_of_cancelled = 'running')) END AS running_progress
FROM sweep
WHERE hidden IS NULL AND ($1 IS NULL OR owner = $1) AND ($2 IS NULL OR id < $2)
  AND ($4 IS NULL OR $4 = CASE WHEN cancelled THEN 'cancelled'
                               WHEN finished IS NOT NULL THEN 'completed'
                               WHEN paused THEN 'paused'
                               ELSE 'running' END)
  AND ($5 IS NULL OR strpos(lower(name COLLATE "C"), lower($5 COLLATE "C")) > 0)
  AND ($6 IS NULL OR EXISTS (SELECT 1 FROM json_array_elements_text(tags::json) AS tag (value) WHERE value = $6))
  AND ($7 IS NULL OR substr(id, 1, length($7)) = lower($7))
ORDER BY id DESC LIMIT $3
