-- Notes that a token was used.
-- $1 token, $2 time.
UPDATE token SET last_used = $2 WHERE id = $1
