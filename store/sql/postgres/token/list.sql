-- All tokens, oldest first.
SELECT id, owner, name, scope, created, expires, revoked, last_used FROM token ORDER BY created, id
