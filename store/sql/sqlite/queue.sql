-- name: BEGIN_TO_LOOK
-- Whether it is time that somebody looks for what is due: always. A look costs little where few processes share a file.
-- $1 how long nobody need look after somebody has [ms].
SELECT $1 >= 0

-- name: CLAIM
-- Hands out the next work item: of the owner whose turn it is the most urgent, of these the first in the order asked for.
-- $1 worker, $2 length of the lease [ms], $3 version of the numbers.
-- Gives: work item, fencing token, base, changes, checkpoint; nothing if no work is ready.
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
-- Takes work back whose lease has run out: a death of the worker, and the last that the work is given makes it dead. A
-- result from before stays, and the work is done then.
-- $1 deaths that make it dead.
-- Gives: new state, deaths, worker, what is known of it.
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
-- Ends work whose version of the numbers no worker computes any more. A result from before stays, and the work is done then.
-- $1 version of the numbers that is computed now, $2 how lately a worker must have been heard of [ms], $3 how many at most.
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
-- Nothing: there, statements are no messages, and it is done step by step.
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table), $7 length of the
-- lease [ms], $8 version of the numbers.
-- Gives: nothing.
SELECT '', NULL, NULL, NULL, NULL, NULL WHERE coalesce($1, $2, $3, $4, $5, $6, $7, $8) IS NULL

-- name: FINISH_AT_ONCE
-- Nothing: there, statements are no messages, and it is done step by step.
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table).
-- Gives: nothing.
SELECT '' WHERE coalesce($1, $2, $3, $4, $5, $6) IS NULL

-- name: IS_ANYTHING_OUTDATED
-- Whether work waits whose version of the numbers no worker computes any more.
-- $1 version of the numbers that is computed now, $2 how lately a worker must have been heard of [ms].
SELECT EXISTS (SELECT 1 FROM work
               WHERE is_open AND physics_version < $1 AND state <> 'leased'
                 AND NOT EXISTS (SELECT 1 FROM worker
                                 WHERE worker.physics_version = work.physics_version
                                   AND last_seen > (SELECT now FROM clock) - $2))

-- name: KEEP_DISAGREEMENT
-- Marks a result as one of which another has been seen, though it agrees with the one before it.
-- $1 work item, $2 provenance of the one before.
UPDATE result SET
    disagrees = 1,
    provenance = json_set(provenance, '$.disagreement', json_extract($2, '$.disagreement'))
WHERE work_key = $1

-- name: NOTE_DISAGREEMENT
-- Marks a result as other than the one before it.
-- $1 work item, $2 what differs, $3 provenance of the one before.
UPDATE result SET
    disagrees = 1,
    provenance = json_set(provenance, '$.disagreement',
                          json_object('differs', $2, 'earlier', json_remove($3, '$.disagreement')))
WHERE work_key = $1

-- name: RETRY_LATER
-- Ends a lease after the infrastructure failed: the work waits, twice as long as the time before and up to half as long
-- again by chance, and fails at the last try that it is given. A result from before stays, and the work is done then.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON, $5 tries, $6 least wait before the first retry [ms].
-- Of the random number the bits without the sign's: the absolute value of the least integer is none.
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
