-- Whether a row names a blob, as in `blobs_in_use`.
-- $1 blob.
SELECT EXISTS (SELECT 1 FROM artifact WHERE blob = $1 AND expired IS NULL)
    OR EXISTS (SELECT 1 FROM work WHERE checkpoint = $1)
