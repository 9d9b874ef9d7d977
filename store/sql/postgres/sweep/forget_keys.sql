-- Forgets for which idempotency keys a sweep was made.
-- $1 sweep.
DELETE FROM idempotency WHERE sweep_id = $1
