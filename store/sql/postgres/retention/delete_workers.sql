-- Deletes workers that have been silent for long.
-- $1 time up to which.
DELETE FROM worker WHERE last_seen <= $1
