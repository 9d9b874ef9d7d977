-- Counts the sweeps, and adds up their counts of points.
-- Gives: number of sweeps, points queued, running, done, failed, cancelled.
SELECT count(*), coalesce(sum(points_queued), 0)::bigint, coalesce(sum(points_running), 0)::bigint, coalesce(sum(points_done), 0)::bigint,
       coalesce(sum(points_failed), 0)::bigint, coalesce(sum(points_cancelled), 0)::bigint
FROM sweep
