-- Ends work whose version of the numbers no worker computes any more. A result from before stays, and the work is done then.
-- $1 version of the numbers that is computed now, $2 how lately a worker must have been heard of [ms], $3 how many at most.
-- Each of the three kinds of waiting work by an index of its own.
UPDATE work SET
    state = CASE WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done' ELSE 'failed' END,
    error = json_build_object('class', 'outdated', 'reason',
        format('no worker computes physics version %s any more; submit the scenario again, for version %s',
               physics_version, $1))::text,
    progress = 0, changed = (SELECT now FROM clock)
WHERE key IN (SELECT key
              FROM (SELECT key, physics_version FROM work WHERE state = 'queued' AND NOT held AND physics_version < $1
                    UNION ALL
                    SELECT key, physics_version FROM work WHERE state = 'queued' AND held AND physics_version < $1
                    UNION ALL
                    SELECT key, physics_version FROM work WHERE state = 'waiting' AND physics_version < $1) AS open
              WHERE NOT EXISTS (SELECT 1 FROM worker
                                WHERE worker.physics_version = open.physics_version
                                  AND last_seen > (SELECT now FROM clock) - $2)
              LIMIT $3)
