-- Whether the result of a work item names a blob.
-- $1 work item, $2 blob.
SELECT EXISTS (SELECT 1 FROM artifact WHERE work_key = $1 AND blob = $2 AND expired IS NULL)
