-- name: BLOBS
-- Page of the blobs of unexpired artifacts and of checkpoints.
-- $1 name before the first, $2 largest number of rows.
-- Returns: the blob's name.
SELECT blob FROM artifact WHERE expired IS NULL AND blob > $1
UNION SELECT checkpoint FROM work WHERE checkpoint > $1
ORDER BY 1 LIMIT $2

-- name: COUNT_BLOBS
-- Number of blobs of unexpired artifacts and of checkpoints.
-- Returns: the number.
SELECT count(*) FROM (SELECT blob FROM artifact WHERE expired IS NULL
                      UNION SELECT checkpoint FROM work WHERE checkpoint IS NOT NULL) AS named

-- name: RELEASE
-- Releases all leased work of the source: it is queued, or cancelled if a cancellation was requested. If the work ends here and has an
-- earlier result, its state becomes done.
UPDATE work SET
    state = CASE WHEN NOT cancel_requested THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 ELSE 'cancelled' END,
    error = NULL, attempts = attempts - 1, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE state = 'leased'

-- name: USERS
-- Users of the store.
-- $1 largest age of a worker's heartbeat [ms].
-- Returns: number of valid leases, number of workers with a recent heartbeat.
SELECT (SELECT count(*) FROM work WHERE state = 'leased' AND lease_until > (SELECT now FROM clock)),
       (SELECT count(*) FROM worker
        WHERE last_seen > (SELECT now FROM clock) - $1 AND last_seen < (SELECT now FROM clock) + $1)
