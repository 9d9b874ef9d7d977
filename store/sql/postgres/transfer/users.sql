-- Who is at work.
-- $1 how lately a worker must have been heard of [ms].
-- Gives: how many leases have not run out, how many workers there are.
SELECT (SELECT count(*) FROM work WHERE state = 'leased' AND lease_until > (SELECT now FROM clock)),
       (SELECT count(*) FROM worker
        WHERE last_seen > (SELECT now FROM clock) - $1 AND last_seen < (SELECT now FROM clock) + $1)
