-- What must be known of a work item to queue it anew.
-- $1 work item.
-- Gives: owner, state, version of the numbers.
SELECT owner, state, physics_version FROM work WHERE key = $1
