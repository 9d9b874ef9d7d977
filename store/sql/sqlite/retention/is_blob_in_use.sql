-- Whether a row names a blob, as in `blobs_in_use`, or one will: while it is reserved.
-- ?1 blob.
SELECT EXISTS (SELECT 1 FROM artifact WHERE blob = ?1 AND expired IS NULL)
    OR EXISTS (SELECT 1 FROM work WHERE checkpoint = ?1)
    OR EXISTS (SELECT 1 FROM upload WHERE blob = ?1 AND expires > (SELECT now FROM clock))
