-- Takes a sweep's cancellation back.
-- $1 sweep.
-- Gives: owner.
UPDATE sweep SET cancelled = false, cancelled_to = NULL, version = version + 1, revision = revision + 1 WHERE id = $1 AND hidden IS NULL RETURNING owner
