-- What an idempotency key was used for.
-- $1 owner, $2 key.
-- Gives: hash of the request's body, sweep, whether that is hidden.
SELECT body_hash, sweep_id, hidden IS NOT NULL FROM idempotency JOIN sweep ON id = sweep_id
WHERE idempotency.owner = $1 AND key = $2
