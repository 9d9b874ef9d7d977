-- Whether work waits whose version of the numbers no worker computes any more.
-- $1 version of the numbers that is computed now, $2 how lately a worker must have been heard of [ms].
SELECT EXISTS (SELECT 1 FROM work
               WHERE is_open AND physics_version < $1 AND state <> 'leased'
                 AND NOT EXISTS (SELECT 1 FROM worker
                                 WHERE worker.physics_version = work.physics_version
                                   AND last_seen > (SELECT now FROM clock) - $2))
