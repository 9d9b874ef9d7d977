-- Hands out the next work item: of the owner whose turn it is the most urgent, of these the first in the order asked for.
-- $1 worker, $2 length of the lease [ms], $3 version of the numbers.
-- What others are claiming is skipped, and an owner with nothing else. The owners are gone through in the order of their turns, as far as
-- the first that has something: the order is that of the inner query.
-- Gives: work item, fencing token, base, changes, checkpoint; nothing if no work is ready.
WITH picked AS (
    SELECT ready.key
    FROM (SELECT owner FROM owner_turn ORDER BY vtime, owner) AS turn
    CROSS JOIN LATERAL (
        SELECT key FROM work
        WHERE state = 'queued' AND NOT held AND physics_version = $3 AND work.owner = turn.owner
        ORDER BY priority DESC, vtime, key LIMIT 1
        FOR NO KEY UPDATE SKIP LOCKED) AS ready
    LIMIT 1)
UPDATE work SET
    state = 'leased', fencing_token = fencing_token + 1, attempts = attempts + 1, progress = 0,
    worker_note = NULL, lease_owner = $1, lease_until = (SELECT now FROM clock) + $2, lease_ms = $2, changed = (SELECT now FROM clock)
FROM picked
WHERE work.key = picked.key
RETURNING work.key, fencing_token, (SELECT text FROM scenario WHERE hash = work.base), changes, checkpoint
