-- Counts the tokens.
-- Gives: all, those that are valid now.
SELECT count(*), count(*) FILTER (WHERE revoked IS NULL AND (expires IS NULL OR expires > (SELECT now FROM clock)))
FROM token
