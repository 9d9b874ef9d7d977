-- name: BLOBS
-- A page of the blobs that rows name: of artifacts that have not expired, and of checkpoints that runs go on from.
-- $1 name after which it begins, $2 how many at most.
-- Gives: the blob's name.
SELECT blob FROM artifact WHERE expired IS NULL AND blob > $1
UNION SELECT checkpoint FROM work WHERE checkpoint > $1
ORDER BY 1 LIMIT $2

-- name: COUNT_BLOBS
-- How many blobs rows name: of artifacts that have not expired, and of checkpoints that runs go on from.
-- Gives: the number.
SELECT count(*) FROM (SELECT blob FROM artifact WHERE expired IS NULL
                      UNION SELECT checkpoint FROM work WHERE checkpoint IS NOT NULL) AS named

-- name: RELEASE
-- Gives all work back that was leased where it comes from: it is queued, or cancelled where nobody wants it any more. A result from before
-- stays, and the work is done then.
UPDATE work SET
    state = CASE WHEN NOT cancel_requested THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 ELSE 'cancelled' END,
    error = NULL, attempts = attempts - 1, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE state = 'leased'

-- name: USERS
-- Who is at work.
-- $1 how lately a worker must have been heard of [ms].
-- Gives: how many leases have not run out, how many workers there are.
SELECT (SELECT count(*) FROM work WHERE state = 'leased' AND lease_until > (SELECT now FROM clock)),
       (SELECT count(*) FROM worker
        WHERE last_seen > (SELECT now FROM clock) - $1 AND last_seen < (SELECT now FROM clock) + $1)
