-- name: BEGIN_TO_LOOK
-- Whether it is time that somebody looks for what is due, who then is the one that asks (migrations/postgres/0001_schema.sql).
-- $1 how long nobody need look after somebody has [ms].
SELECT begin_to_look($1)

-- name: CLAIM
-- Hands out the next work item: of the owner whose turn it is the most urgent, of these the first in the order asked for
-- (migrations/postgres/0001_schema.sql).
-- $1 worker, $2 length of the lease [ms], $3 version of the numbers.
-- Gives: work item, fencing token, base, changes, checkpoint; nothing if no work is ready.
SELECT key, fencing_token, base, changes, checkpoint FROM claim_work($1, $2, $3)

-- name: END_LEASES
-- Takes work back whose lease has run out: a death of the worker, and the last that the work is given makes it dead. A
-- result from before stays, and the work is done then.
-- $1 deaths that make it dead.
-- Gives: new state, deaths, worker, what is known of it.
UPDATE work SET
    crash_count = crash_count + 1, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock),
    state = CASE WHEN NOT cancel_requested AND crash_count + 1 < $1 THEN 'queued'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 WHEN cancel_requested THEN 'cancelled'
                 ELSE 'dead' END,
    error = CASE WHEN NOT cancel_requested AND crash_count + 1 >= $1
                 THEN json_build_object('class', 'crash', 'reason',
                      format('%s workers went silent while they simulated it', crash_count + 1)
                          || coalesce('; the last one ' || worker_note, ''))::text
                 ELSE error END
WHERE state = 'leased' AND lease_until < (SELECT now FROM clock)
RETURNING state, crash_count, lease_owner, worker_note

-- name: END_OUTDATED
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

-- name: FINISH_AND_CLAIM
-- Stores a result, where it is the first of its work item, hands the next work item to the same worker, and does what follows from both
-- (migrations/postgres/0001_schema.sql). It commits, and is no part of a transaction.
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table), $7 length of the
-- lease [ms], $8 version of the numbers.
-- Gives: 'done'; 'lost', the lease; 'earlier' if there is a result already; 'missing' and the name of a blob that is not reserved; and after
-- 'done' work item, fencing token, base, changes, checkpoint, if work is ready.
CALL finish_and_claim($1, $2, $3, $4, $5, $6::json, $7, $8, NULL, NULL, NULL, NULL, NULL, NULL)

-- name: FINISH_AT_ONCE
-- Ends a lease with a result, if that is the first of its work item: one statement instead of several, each a message to the server and
-- back (migrations/postgres/0001_schema.sql).
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table).
-- Gives: what came of it; nothing if it has to be done step by step.
SELECT outcome FROM finish_work($1, $2, $3, $4, $5, $6::json) AS done (outcome) WHERE outcome <> 'earlier'

-- name: IS_ANYTHING_OUTDATED
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

-- name: KEEP_DISAGREEMENT
-- Marks a result as one of which another has been seen, though it agrees with the one before it.
-- $1 work item, $2 provenance of the one before.
UPDATE result SET
    disagrees = true,
    provenance = jsonb_set(provenance::jsonb, '{disagreement}', $2::jsonb -> 'disagreement')::text
WHERE work_key = $1

-- name: NOTE_DISAGREEMENT
-- Marks a result as other than the one before it.
-- $1 work item, $2 what differs, $3 provenance of the one before.
UPDATE result SET
    disagrees = true,
    provenance = jsonb_set(provenance::jsonb, '{disagreement}',
                           jsonb_build_object('differs', $2, 'earlier', $3::jsonb - 'disagreement'))::text
WHERE work_key = $1

-- name: RETRY_LATER
-- Ends a lease after the infrastructure failed: the work waits, twice as long as the time before and up to half as long
-- again by chance, and fails at the last try that it is given. A result from before stays, and the work is done then.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON, $5 tries, $6 least wait before the first retry [ms].
UPDATE work SET
    state = CASE WHEN NOT cancel_requested AND failure_count + 1 < $5 THEN 'waiting'
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 WHEN cancel_requested THEN 'cancelled'
                 ELSE 'failed' END,
    ready_at = (SELECT now FROM clock) + ($6 << failure_count::int)
               + floor(random() * (($6 << failure_count::int) / 2 + 1))::bigint,
    failure_count = failure_count + 1,
    error = $4, progress = 0, lease_until = NULL, changed = (SELECT now FROM clock)
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
