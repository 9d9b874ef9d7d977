-- Makes room for a new result; the artifacts of the one before go with it.
-- $1 work item.
DELETE FROM result WHERE work_key = $1
