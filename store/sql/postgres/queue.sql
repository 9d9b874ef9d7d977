-- name: BEGIN_TO_LOOK
-- True if a search for due work is due; the caller then makes it, and no other process (migrations/postgres/0001_schema.sql).
-- $1 interval of searches [ms].
SELECT begin_to_look($1)

-- name: CLAIM
-- Claims the next work item: of the owner whose turn it is the one of highest priority, then the first in order
-- (migrations/postgres/0001_schema.sql).
-- $1 worker, $2 length of the lease [ms], $3 physics version.
-- Returns: work item, fencing token, base, changes, checkpoint; nothing if no work is ready.
SELECT key, fencing_token, base, changes, checkpoint FROM claim_work($1, $2, $3)

-- name: END_LEASES
-- Ends expired leases. Each counts as a crash of the worker; work that reaches the limit becomes dead. If the work ends here and has an
-- earlier result, its state becomes done.
-- $1 limit of crashes.
-- Returns: new state, crashes, worker, note about it.
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
-- Ends waiting work of an earlier physics version without a worker. If the work ends here and has an earlier result, its state becomes done.
-- $1 current physics version, $2 largest age of a worker's heartbeat [ms], $3 largest number of rows.
-- Each of the three kinds of waiting work has its own index.
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
-- Stores the first result of a work item, claims the next work item for the same worker, and applies the consequences of both
-- (migrations/postgres/0001_schema.sql). It commits by itself and cannot be part of a transaction.
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table), $7
-- length of the lease [ms], $8 physics version.
-- Returns: 'done'; 'lost', the lease; 'earlier' if there is a result already; 'missing' and the name of a blob that is not reserved; and
-- after 'done' work item, fencing token, base, changes, checkpoint, if work is ready.
CALL finish_and_claim($1, $2, $3, $4, $5, $6::json, $7, $8, NULL, NULL, NULL, NULL, NULL, NULL)

-- name: FINISH_AT_ONCE
-- Ends a lease with a result, if that is the first of its work item: one round trip instead of several
-- (migrations/postgres/0001_schema.sql).
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table).
-- Returns: the outcome; nothing if single statements are needed.
SELECT outcome FROM finish_work($1, $2, $3, $4, $5, $6::json) AS done (outcome) WHERE outcome <> 'earlier'

-- name: IS_ANYTHING_OUTDATED
-- True if work of an earlier physics version without a worker waits.
-- $1 current physics version, $2 largest age of a worker's heartbeat [ms].
-- Each of the three has its own index.
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
-- Keeps the mark and the record of an earlier disagreement on a result that agrees with the one before it.
-- $1 work item, $2 provenance of the earlier result.
UPDATE result SET
    disagrees = true,
    provenance = jsonb_set(provenance::jsonb, '{disagreement}', $2::jsonb -> 'disagreement')::text
WHERE work_key = $1

-- name: NOTE_DISAGREEMENT
-- Marks a result as different from the one before it, and records the difference.
-- $1 work item, $2 difference, $3 provenance of the earlier result.
UPDATE result SET
    disagrees = true,
    provenance = jsonb_set(provenance::jsonb, '{disagreement}',
                           jsonb_build_object('differs', $2, 'earlier', $3::jsonb - 'disagreement'))::text
WHERE work_key = $1

-- name: RETRY_LATER
-- Ends a lease after a failure of the infrastructure: the work waits with exponential backoff and up to 50 % jitter, and fails at the
-- last try. If the work ends here and has an earlier result, its state becomes done.
-- $1 work item, $2 fencing token, $3 worker, $4 error, JSON, $5 largest number of tries, $6 least wait before the first retry [ms].
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
