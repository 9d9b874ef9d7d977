-- Deletes old events.
-- $1 time up to which.
DELETE FROM event WHERE at <= $1
