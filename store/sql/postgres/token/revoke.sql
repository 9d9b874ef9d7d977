-- Makes a token void.
-- $1 token.
UPDATE token SET revoked = coalesce(revoked, (SELECT now FROM clock)) WHERE id = $1
