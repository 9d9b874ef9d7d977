-- name: BLOBS
-- Blobs of unexpired artifacts.
-- Returns: the blob's name, its size.
SELECT blob, max(bytes) FROM artifact WHERE expired IS NULL GROUP BY blob ORDER BY blob

-- name: RESULTS
-- Counts the results.
SELECT count(*) FROM result

-- name: WITHOUT_RESULT
-- Done work items without a result.
SELECT key FROM work LEFT JOIN result ON work_key = key WHERE state = 'done' AND work_key IS NULL ORDER BY key
