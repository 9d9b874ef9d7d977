-- Deletes the finished sweeps whose time has come; their points, events, requests and idempotency keys go with them.
-- $1 time.
DELETE FROM sweep WHERE NOT pinned AND expires <= $1 AND finished IS NOT NULL
