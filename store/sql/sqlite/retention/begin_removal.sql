-- Notes that a blob is being deleted: nobody reserves it meanwhile.
-- ?1 blob, ?2 for how long that may take [ms].
INSERT INTO removal (blob, expires) VALUES (?1, (SELECT now FROM clock) + ?2)
ON CONFLICT (blob) DO UPDATE SET expires = excluded.expires
