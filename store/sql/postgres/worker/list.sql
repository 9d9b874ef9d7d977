-- Workers heard of lately, oldest first. One that was last heard of in the future, as it seems after the clock was set
-- back, has been silent since.
-- $1 how lately [ms].
SELECT id, host, process, version, physics_version, started, last_seen FROM worker
WHERE last_seen > (SELECT now FROM clock) - $1 AND last_seen < (SELECT now FROM clock) + $1
ORDER BY started, id
