-- name: CANCEL
-- Ends a lease after a cancellation; if the work was requested again since the worker's last renewal, it is queued. If the work ends
-- here and has an earlier result, its state becomes done.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON.
UPDATE work SET
    state = CASE WHEN NOT cancel_requested THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 ELSE 'cancelled' END,
    error = CASE WHEN NOT cancel_requested OR EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN NULL
                 ELSE $4 END,
    progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'

-- name: CRASH
-- Ends a lease after a crash that the worker process survived. It counts as a crash; work that reaches the limit becomes dead. If the
-- work ends here and has an earlier result, its state becomes done.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON, $5 limit of crashes.
UPDATE work SET
    crash_count = crash_count + 1, progress = 0, lease_until = NULL, error = $4, changed = (SELECT now FROM clock),
    state = CASE WHEN NOT cancel_requested AND crash_count + 1 < $5 THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 WHEN cancel_requested THEN 'cancelled'
                 ELSE 'dead' END
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'

-- name: DELETE_RESULT
-- Deletes an earlier result, with its artifacts, before a new one is stored.
-- $1 work item.
DELETE FROM result WHERE work_key = $1

-- name: DEPTHS
-- Counts the open work items by state.
-- Returns: waiting, queued, queued but held (paused), leased.
SELECT count(*) FILTER (WHERE state = 'waiting'), count(*) FILTER (WHERE state = 'queued' AND NOT held),
       count(*) FILTER (WHERE state = 'queued' AND held), count(*) FILTER (WHERE state = 'leased')
FROM work WHERE is_open

-- name: EARLIER_BLOBS
-- Artifacts of an earlier result.
-- $1 work item.
-- Returns: name, blob.
SELECT name, blob FROM artifact WHERE work_key = $1

-- name: EARLIER_RESULT
-- An earlier result.
-- $1 work item.
-- Returns: summary, provenance, true if it disagrees with one before it.
SELECT summary, provenance, disagrees FROM result WHERE work_key = $1

-- name: FAIL
-- Ends a lease without a result; there is no retry. If the work ends here and has an earlier result, its state becomes done.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON.
UPDATE work SET
    state = CASE WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done' ELSE 'failed' END,
    error = $4, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'

-- name: FINISH
-- Ends a lease with a result.
-- $1 work item, $2 fencing token, $3 worker.
-- Returns: the time; nothing if the lease is lost.
UPDATE work SET
    state = 'done', progress = 1, error = NULL, checkpoint = NULL, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
RETURNING changed

-- name: INSERT_ARTIFACT
-- Stores an artifact of a result.
-- $1 work item, $2 name, $3 media type, $4 blob, $5 its size, $6 rows of the table.
INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count) VALUES ($1, $2, $3, $4, $5, $6)

-- name: INSERT_RESULT
-- Stores a result.
-- $1 work item, $2 summary, $3 provenance, $4 time.
INSERT INTO result (work_key, summary, provenance, created) VALUES ($1, $2, $3, $4)

-- name: IS_ANYTHING_DUE
-- True if a lease has expired or a retry is due, or if either ends later than it would from now on, which shows that the clock was set
-- back.
-- $1 longest wait of a retry [ms].
SELECT EXISTS (SELECT 1 FROM work WHERE state = 'leased' AND lease_until < (SELECT now FROM clock))
    OR EXISTS (SELECT 1 FROM work WHERE state = 'leased' AND lease_until > (SELECT now FROM clock) + lease_ms)
    OR EXISTS (SELECT 1 FROM work
               WHERE state = 'waiting'
                 AND (ready_at <= (SELECT now FROM clock) OR ready_at > (SELECT now FROM clock) + $1))

-- name: KEEP_CHECKPOINT
-- Stores the checkpoint's blob from which the work can resume.
-- $1 work item, $2 fencing token, $3 worker, $4 blob.
UPDATE work SET checkpoint = $4
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'

-- name: NOTE_WORKER
-- Stores a note about the worker that holds the lease.
-- $1 work item, $2 fencing token, $3 worker, $4 the note.
UPDATE work SET worker_note = $4
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'

-- name: OPEN_WORK
-- Counts the open work items of an owner.
-- $1 owner.
SELECT count(*) FROM work WHERE owner = $1 AND is_open

-- name: RELEASE
-- Ends a lease without counting an attempt: the work is queued, or cancelled if a cancellation was requested. If the work ends here and
-- has an earlier result, its state becomes done.
-- $1 work item, $2 fencing token, $3 worker.
UPDATE work SET
    state = CASE WHEN NOT cancel_requested THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 ELSE 'cancelled' END,
    error = NULL, attempts = attempts - 1, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'

-- name: SHORTEN_LEASES
-- Shortens leases that end later than their full length from now, as after the clock was set back.
UPDATE work SET lease_until = (SELECT now FROM clock) + lease_ms
WHERE state = 'leased' AND lease_until > (SELECT now FROM clock) + lease_ms

-- name: WAKE
-- Queues retries that are due, and those that wait longer than the longest wait from now on, as after the clock was set back.
-- $1 longest wait of a retry [ms].
UPDATE work SET state = 'queued', changed = (SELECT now FROM clock)
WHERE state = 'waiting'
  AND (ready_at <= (SELECT now FROM clock) OR ready_at > (SELECT now FROM clock) + $1)
