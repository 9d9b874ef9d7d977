-- The token of a text, if it is valid now.
-- $1 hash of the text.
SELECT id, owner, name, scope, created, expires, revoked, last_used FROM token
WHERE hash = $1 AND revoked IS NULL AND (expires IS NULL OR expires > (SELECT now FROM clock))
