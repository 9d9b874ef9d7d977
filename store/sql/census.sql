-- name: ARTIFACT_BYTES
-- Size of all artifacts, those that share a blob counted each time.
SELECT CAST(coalesce(sum(bytes), 0) AS bigint) FROM artifact

-- name: SWEEPS
-- Counts the sweeps, and adds up their counts of points.
-- Gives: number of sweeps, points queued, running, done, failed, cancelled.
SELECT count(*), CAST(coalesce(sum(points_queued), 0) AS bigint), CAST(coalesce(sum(points_running), 0) AS bigint), CAST(coalesce(sum(points_done), 0) AS bigint),
       CAST(coalesce(sum(points_failed), 0) AS bigint), CAST(coalesce(sum(points_cancelled), 0) AS bigint)
FROM sweep
