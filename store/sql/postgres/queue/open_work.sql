-- Counts the open work items of an owner.
-- $1 owner.
SELECT count(*) FROM work WHERE owner = $1 AND is_open
