-- Closes a session.
-- $1 hash of its text.
DELETE FROM session WHERE hash = $1
