-- Reserves a blob for a row to come, unless it is being deleted: it is not deleted until then. Who has reserved it for longer keeps it.
-- ?1 blob, ?2 for how long [ms].
-- Gives: the blob; nothing if it is being deleted.
INSERT INTO upload (blob, expires)
SELECT ?1, (SELECT now FROM clock) + ?2
WHERE NOT EXISTS (SELECT 1 FROM removal WHERE blob = ?1 AND expires > (SELECT now FROM clock))
ON CONFLICT (blob) DO UPDATE SET expires = max(upload.expires, excluded.expires)
RETURNING blob
