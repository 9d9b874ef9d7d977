-- Marks a result as damaged, unless it is so already.
-- $1 work item.
UPDATE result SET damaged = (SELECT now FROM clock) WHERE work_key = $1 AND damaged IS NULL
