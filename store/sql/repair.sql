-- name: MARK
-- Marks a result as damaged, unless it is so already.
-- $1 work item.
UPDATE result SET damaged = (SELECT now FROM clock) WHERE work_key = $1 AND damaged IS NULL

-- name: NAMES_BLOB
-- Whether the result of a work item names a blob.
-- $1 work item, $2 blob.
SELECT EXISTS (SELECT 1 FROM artifact WHERE work_key = $1 AND blob = $2 AND expired IS NULL)

-- name: WORK
-- What must be known of a work item to queue it anew.
-- $1 work item.
-- Gives: owner, state, version of the numbers.
SELECT owner, state, physics_version FROM work WHERE key = $1

-- name: WORKS_OF_BLOB
-- The work items whose results name a blob, with the names of their tables.
-- $1 blob.
SELECT work_key, name FROM artifact WHERE blob = $1 AND expired IS NULL ORDER BY work_key, name
