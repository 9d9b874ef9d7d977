-- Hands out the next work item: of the owner whose turn it is the most urgent, of these the first in the order asked for.
-- ?1 worker, ?2 length of the lease [ms], ?3 version of the numbers.
-- Gives: work item, fencing token, base, changes, checkpoint; nothing if no work is ready.
UPDATE work SET
    state = 'leased', fencing_token = fencing_token + 1, attempts = attempts + 1, progress = 0,
    worker_note = NULL, lease_owner = ?1, lease_until = (SELECT now FROM clock) + ?2, lease_ms = ?2, changed = (SELECT now FROM clock)
WHERE key = (
    SELECT key FROM work
    WHERE state = 'queued' AND held = 0 AND physics_version = ?3
      AND owner = (SELECT owner FROM owner_turn
                   WHERE EXISTS (SELECT 1 FROM work
                                 WHERE state = 'queued' AND held = 0 AND physics_version = ?3
                                   AND work.owner = owner_turn.owner)
                   ORDER BY vtime, owner LIMIT 1)
    ORDER BY priority DESC, vtime, key LIMIT 1)
RETURNING key, fencing_token, (SELECT text FROM scenario WHERE hash = work.base), changes, checkpoint
