-- Whether work waits whose version of the numbers no worker computes any more.
-- $1 version of the numbers that is computed now, $2 how lately a worker must have been heard of [ms].
-- Each of the three by an index of its own.
SELECT EXISTS (SELECT 1 FROM work
               WHERE state = 'queued' AND NOT held AND physics_version < $1
                 AND NOT EXISTS (SELECT 1 FROM worker
                                 WHERE worker.physics_version = work.physics_version
                                   AND last_seen > (SELECT now FROM clock) - $2))
    OR EXISTS (SELECT 1 FROM work
               WHERE state = 'queued' AND held AND physics_version < $1
                 AND NOT EXISTS (SELECT 1 FROM worker
                                 WHERE worker.physics_version = work.physics_version
                                   AND last_seen > (SELECT now FROM clock) - $2))
    OR EXISTS (SELECT 1 FROM work
               WHERE state = 'waiting' AND physics_version < $1
                 AND NOT EXISTS (SELECT 1 FROM worker
                                 WHERE worker.physics_version = work.physics_version
                                   AND last_seen > (SELECT now FROM clock) - $2))
