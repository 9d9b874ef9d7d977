-- Deletes a sweep; its points, events, requests and idempotency keys go with it.
-- $1 sweep.
DELETE FROM sweep WHERE id = $1
