-- name: CREATE
-- Stores a token, unless its text is stored already.
-- $1 token, $2 hash of its text, $3 owner, $4 name, $5 scope, $6 validity [ms], or null without end.
INSERT INTO token (id, hash, owner, name, scope, created, expires)
VALUES ($1, $2, $3, $4, $5, (SELECT now FROM clock), (SELECT now FROM clock) + $6)
ON CONFLICT (hash) DO NOTHING
