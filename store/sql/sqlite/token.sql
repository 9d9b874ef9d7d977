-- name: CREATE
-- Stores a token; one whose text is stored already stays as it is.
-- $1 token, $2 hash of its text, $3 owner, $4 name, $5 scope, $6 how long it is valid [ms], or none for ever.
INSERT INTO token (id, hash, owner, name, scope, created, expires)
VALUES ($1, $2, $3, $4, $5, (SELECT now FROM clock), (SELECT now FROM clock) + $6)
ON CONFLICT (hash) DO NOTHING
