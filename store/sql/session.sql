-- name: CLOSE
-- Closes a session.
-- $1 hash of its text.
DELETE FROM session WHERE hash = $1

-- name: OPEN
-- Opens a session.
-- $1 hash of its text, $2 token, $3 validity [ms].
INSERT INTO session (hash, token_id, created, expires)
VALUES ($1, $2, (SELECT now FROM clock), (SELECT now FROM clock) + $3)

-- name: TOKEN
-- Token of a session, if both are valid, and the earlier of both expiries.
-- $1 hash of the session's text.
SELECT t.id, t.owner, t.name, t.scope, t.created, t.expires, t.revoked, t.last_used,
       CASE WHEN t.expires < s.expires THEN t.expires ELSE s.expires END AS session_expires
FROM session s JOIN token t ON t.id = s.token_id
WHERE s.hash = $1 AND s.expires > (SELECT now FROM clock)
  AND t.revoked IS NULL AND (t.expires IS NULL OR t.expires > (SELECT now FROM clock))
