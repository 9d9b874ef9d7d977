-- name: LIST
-- All tokens, oldest first.
SELECT id, owner, name, scope, created, expires, revoked, last_used FROM token ORDER BY created, id

-- name: PRESENT
-- Counts the tokens.
-- Returns: all, valid ones.
SELECT count(*), count(*) FILTER (WHERE revoked IS NULL AND (expires IS NULL OR expires > (SELECT now FROM clock)))
FROM token

-- name: REVOKE
-- Revokes a token; a second revocation keeps the first time.
-- $1 token.
UPDATE token SET revoked = coalesce(revoked, (SELECT now FROM clock)) WHERE id = $1

-- name: TOUCH
-- Stores the time of a token's last use.
-- $1 token, $2 time.
UPDATE token SET last_used = $2 WHERE id = $1

-- name: VALID
-- Valid token of a text.
-- $1 hash of the text.
SELECT id, owner, name, scope, created, expires, revoked, last_used FROM token
WHERE hash = $1 AND revoked IS NULL AND (expires IS NULL OR expires > (SELECT now FROM clock))
