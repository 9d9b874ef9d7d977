-- Deletes old idempotency keys.
-- $1 time up to which.
DELETE FROM idempotency WHERE created <= $1
