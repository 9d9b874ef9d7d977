-- name: LIST
-- All tokens, oldest first.
SELECT id, owner, name, scope, created, expires, revoked, last_used FROM token ORDER BY created, id

-- name: PRESENT
-- Counts the tokens.
-- Gives: all, those that are valid now.
SELECT count(*), count(*) FILTER (WHERE revoked IS NULL AND (expires IS NULL OR expires > (SELECT now FROM clock)))
FROM token

-- name: REVOKE
-- Makes a token void.
-- $1 token.
UPDATE token SET revoked = coalesce(revoked, (SELECT now FROM clock)) WHERE id = $1

-- name: TOUCH
-- Notes that a token was used.
-- $1 token, $2 time.
UPDATE token SET last_used = $2 WHERE id = $1

-- name: VALID
-- The token of a text, if it is valid now.
-- $1 hash of the text.
SELECT id, owner, name, scope, created, expires, revoked, last_used FROM token
WHERE hash = $1 AND revoked IS NULL AND (expires IS NULL OR expires > (SELECT now FROM clock))
