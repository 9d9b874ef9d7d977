-- name: MARK
-- Marks a result as damaged, unless it is marked already.
-- $1 work item.
UPDATE result SET damaged = (SELECT now FROM clock) WHERE work_key = $1 AND damaged IS NULL

-- name: NAMES_BLOB
-- True if the result of a work item has an unexpired artifact with a blob.
-- $1 work item, $2 blob.
SELECT EXISTS (SELECT 1 FROM artifact WHERE work_key = $1 AND blob = $2 AND expired IS NULL)

-- name: WORK
-- Data needed to queue a work item again.
-- $1 work item.
-- Returns: owner, state, physics version.
SELECT owner, state, physics_version FROM work WHERE key = $1

-- name: WORKS_OF_BLOB
-- Work items with an unexpired artifact in a blob, and the names of the artifacts.
-- $1 blob.
SELECT work_key, name FROM artifact WHERE blob = $1 AND expired IS NULL ORDER BY work_key, name
