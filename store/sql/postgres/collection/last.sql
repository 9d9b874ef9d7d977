-- The last collection.
-- Gives: when it began, when one ended last, what that deleted, JSON.
SELECT started, ended, deleted FROM collection WHERE id = 1
