-- Reserves a blob for a row to come: it is not deleted until then. Who has reserved it for longer keeps it.
-- ?1 blob, ?2 for how long [ms].
INSERT INTO upload (blob, expires) VALUES (?1, (SELECT now FROM clock) + ?2)
ON CONFLICT (blob) DO UPDATE SET expires = max(expires, excluded.expires)
