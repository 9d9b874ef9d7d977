-- Takes a sweep's cancellation back.
-- ?1 sweep.
-- Gives: owner.
UPDATE sweep SET cancelled = 0, version = version + 1, revision = revision + 1 WHERE id = ?1 RETURNING owner
