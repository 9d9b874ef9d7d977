-- Those of some blobs that are not reserved, or not any more.
-- ?1 their names, a JSON array.
SELECT value FROM json_each(?1)
WHERE NOT EXISTS (SELECT 1 FROM upload WHERE blob = value AND expires > (SELECT now FROM clock))
