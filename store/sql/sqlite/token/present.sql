-- Counts the tokens.
-- Gives: all, those that are valid now.
SELECT count(*),
       coalesce(sum(revoked IS NULL AND (expires IS NULL OR expires > (SELECT now FROM clock))), 0)
FROM token
