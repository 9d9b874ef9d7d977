-- The blobs that results name.
-- Gives: the blob's name, its size.
SELECT blob, max(bytes) FROM artifact WHERE expired IS NULL GROUP BY blob ORDER BY blob
