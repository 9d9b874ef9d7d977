-- What an idempotency key was used for.
-- ?1 owner, ?2 key.
-- Gives: hash of the request's body, sweep.
SELECT body_hash, sweep_id FROM idempotency WHERE owner = ?1 AND key = ?2
