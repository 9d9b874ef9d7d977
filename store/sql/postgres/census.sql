-- name: DISAGREEMENTS
-- Counts the results that were recomputed and differ.
SELECT count(*) FROM result WHERE disagrees

-- name: OLDEST_QUEUED
-- Waiting time of the oldest ready work item [ms].
SELECT coalesce(greatest(0, (SELECT now FROM clock) - min(changed)), 0)::bigint FROM work WHERE state = 'queued' AND NOT held
