-- Opens a session.
-- $1 hash of its text, $2 token, $3 how long it is valid [ms].
INSERT INTO session (hash, token_id, created, expires)
VALUES ($1, $2, (SELECT now FROM clock), (SELECT now FROM clock) + $3)
