-- name: DISAGREEMENTS
-- Counts the results that were recomputed and differ.
SELECT count(*) FROM result WHERE disagrees <> 0

-- name: OLDEST_QUEUED
-- Waiting time of the oldest ready work item [ms].
SELECT coalesce(max(0, (SELECT now FROM clock) - min(changed)), 0) FROM work WHERE state = 'queued' AND held = 0
