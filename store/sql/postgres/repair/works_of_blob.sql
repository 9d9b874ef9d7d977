-- The work items whose results name a blob, with the names of their tables.
-- $1 blob.
SELECT work_key, name FROM artifact WHERE blob = $1 AND expired IS NULL ORDER BY work_key, name
