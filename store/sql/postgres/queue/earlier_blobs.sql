-- The artifacts of the result that a new one takes the place of.
-- $1 work item.
-- Gives: name, blob.
SELECT name, blob FROM artifact WHERE work_key = $1
