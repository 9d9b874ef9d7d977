-- name: BEGIN_TO_LOOK
-- True if a search for due work is due: always, since few processes share a file and a search is cheap.
-- $1 interval of searches [ms].
SELECT $1 >= 0

-- name: CLAIM
-- Claims the next work item: of the owner whose turn it is the one of highest priority, then the first in order.
-- $1 worker, $2 length of the lease [ms], $3 physics version.
-- Returns: work item, fencing token, base, changes, checkpoint; nothing if no work is ready.
UPDATE work SET
    state = 'leased', fencing_token = fencing_token + 1, attempts = attempts + 1, progress = 0,
    worker_note = NULL, lease_owner = $1, lease_until = (SELECT now FROM clock) + $2, lease_ms = $2, changed = (SELECT now FROM clock)
WHERE key = (
    SELECT key FROM work
    WHERE state = 'queued' AND held = 0 AND physics_version = $3
      AND owner = (SELECT owner FROM owner_turn
                   WHERE EXISTS (SELECT 1 FROM work
                                 WHERE state = 'queued' AND held = 0 AND physics_version = $3
                                   AND work.owner = owner_turn.owner)
                   ORDER BY vtime, owner LIMIT 1)
    ORDER BY priority DESC, vtime, key LIMIT 1)
RETURNING key, fencing_token, (SELECT text FROM scenario WHERE hash = work.base), changes, checkpoint

-- name: END_LEASES
-- Ends expired leases. Each counts as a crash of the worker; work that reaches the limit becomes dead. If the work ends here and has an
-- earlier result, its state becomes done.
-- $1 limit of crashes.
-- Returns: new state, crashes, worker, note about it.
UPDATE work SET
    crash_count = crash_count + 1, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock),
    state = CASE WHEN cancel_requested = 0 AND crash_count + 1 < $1 THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 WHEN cancel_requested <> 0 THEN 'cancelled'
                 ELSE 'dead' END,
    error = CASE WHEN cancel_requested = 0 AND crash_count + 1 >= $1
                 THEN json_object('class', 'crash', 'reason',
                      printf('%d workers went silent while they simulated it', crash_count + 1)
                          || coalesce('; the last one ' || worker_note, ''))
                 ELSE error END
WHERE state = 'leased' AND lease_until < (SELECT now FROM clock)
RETURNING state, crash_count, lease_owner, worker_note

-- name: END_OUTDATED
-- Ends waiting work of an earlier physics version without a worker. If the work ends here and has an earlier result, its state becomes done.
-- $1 current physics version, $2 largest age of a worker's heartbeat [ms], $3 largest number of rows.
UPDATE work SET
    state = CASE WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done' ELSE 'failed' END,
    error = json_object('class', 'outdated', 'reason',
        printf('no worker computes physics version %d any more; submit the scenario again, for version %d',
               physics_version, $1)),
    progress = 0, changed = (SELECT now FROM clock)
WHERE key IN (SELECT key FROM work AS open
              WHERE is_open AND physics_version < $1 AND state <> 'leased'
                AND NOT EXISTS (SELECT 1 FROM worker
                                WHERE worker.physics_version = open.physics_version
                                  AND last_seen > (SELECT now FROM clock) - $2)
              LIMIT $3)

-- name: FINISH_AND_CLAIM
-- No operation: without round trips single statements suffice.
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table), $7
-- length of the lease [ms], $8 physics version.
-- Returns: nothing.
SELECT '', NULL, NULL, NULL, NULL, NULL WHERE coalesce($1, $2, $3, $4, $5, $6, $7, $8) IS NULL

-- name: FINISH_AT_ONCE
-- No operation: without round trips single statements suffice.
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table).
-- Returns: nothing.
SELECT '' WHERE coalesce($1, $2, $3, $4, $5, $6) IS NULL

-- name: IS_ANYTHING_OUTDATED
-- True if work of an earlier physics version without a worker waits.
-- $1 current physics version, $2 largest age of a worker's heartbeat [ms].
SELECT EXISTS (SELECT 1 FROM work
               WHERE is_open AND physics_version < $1 AND state <> 'leased'
                 AND NOT EXISTS (SELECT 1 FROM worker
                                 WHERE worker.physics_version = work.physics_version
                                   AND last_seen > (SELECT now FROM clock) - $2))

-- name: KEEP_DISAGREEMENT
-- Keeps the mark and the record of an earlier disagreement on a result that agrees with the one before it.
-- $1 work item, $2 provenance of the earlier result.
UPDATE result SET
    disagrees = 1,
    provenance = json_set(provenance, '$.disagreement', json_extract($2, '$.disagreement'))
WHERE work_key = $1

-- name: NOTE_DISAGREEMENT
-- Marks a result as different from the one before it, and records the difference.
-- $1 work item, $2 difference, $3 provenance of the earlier result.
UPDATE result SET
    disagrees = 1,
    provenance = json_set(provenance, '$.disagreement',
                          json_object('differs', $2, 'earlier', json_remove($3, '$.disagreement')))
WHERE work_key = $1

-- name: RETRY_LATER
-- Ends a lease after a failure of the infrastructure: the work waits with exponential backoff and up to 50 % jitter, and fails at the
-- last try. If the work ends here and has an earlier result, its state becomes done.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON, $5 largest number of tries, $6 least wait before the first retry [ms].
-- The mask clears the sign bit of the random number: abs() fails for the least integer.
UPDATE work SET
    state = CASE WHEN cancel_requested = 0 AND failure_count + 1 < $5 THEN 'waiting'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 WHEN cancel_requested <> 0 THEN 'cancelled'
                 ELSE 'failed' END,
    ready_at = (SELECT now FROM clock) + ($6 << failure_count)
               + (random() & 0x7fffffffffffffff) % (($6 << failure_count) / 2 + 1),
    failure_count = failure_count + 1,
    error = $4, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
