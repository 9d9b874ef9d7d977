-- Whether a blob is being deleted.
-- $1 blob.
SELECT EXISTS (SELECT 1 FROM removal WHERE blob = $1 AND expires > (SELECT now FROM clock))
