-- Notes what an idempotency key was used for.
-- $1 owner, $2 key, $3 hash of the request's body, $4 sweep, $5 time.
INSERT INTO idempotency (owner, key, body_hash, sweep_id, created) VALUES ($1, $2, $3, $4, $5)
