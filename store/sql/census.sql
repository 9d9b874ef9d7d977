-- name: ARTIFACT_BYTES
-- Size of all artifacts; a blob counts once for each artifact.
SELECT CAST(coalesce(sum(bytes), 0) AS bigint) FROM artifact

-- name: SWEEPS
-- Number of sweeps, and sums of their counts of points.
-- Returns: number of sweeps, points queued, running, done, failed, cancelled.
SELECT count(*), CAST(coalesce(sum(points_queued), 0) AS bigint), CAST(coalesce(sum(points_running), 0) AS bigint), CAST(coalesce(sum(points_done), 0) AS bigint),
       CAST(coalesce(sum(points_failed), 0) AS bigint), CAST(coalesce(sum(points_cancelled), 0) AS bigint)
FROM sweep
