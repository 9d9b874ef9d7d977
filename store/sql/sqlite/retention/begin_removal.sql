-- Notes that a blob is being deleted, unless somebody else is deleting it: nobody reserves it meanwhile.
-- ?1 blob, ?2 for how long that may take [ms].
-- Gives: until when that holds, by which it is told from a note that others make later; nothing if somebody else is deleting it.
INSERT INTO removal (blob, expires) VALUES (?1, (SELECT now FROM clock) + ?2)
ON CONFLICT (blob) DO UPDATE SET expires = excluded.expires WHERE removal.expires <= (SELECT now FROM clock)
RETURNING expires
