-- Reserves blobs for rows to come, but those that are being deleted: they are not deleted until then. Who has reserved one for longer
-- keeps it.
-- ?1 their names, a JSON array without repetitions, ?2 for how long [ms].
-- Gives: those that are reserved.
INSERT INTO upload (blob, expires)
SELECT value, (SELECT now FROM clock) + ?2 FROM json_each(?1)
WHERE NOT EXISTS (SELECT 1 FROM removal WHERE blob = value AND expires > (SELECT now FROM clock))
ON CONFLICT (blob) DO UPDATE SET expires = max(upload.expires, excluded.expires)
RETURNING blob
