-- Nothing: there, statements are no messages, and it is done step by step.
-- ?1 work item, ?2 fencing token, ?3 worker, ?4 length of the lease [ms], ?5 names of the blobs, a JSON array without repetitions, ?6 for
-- how long they are reserved [ms].
-- Gives: nothing.
SELECT 0, NULL WHERE coalesce(?1, ?2, ?3, ?4, ?5, ?6) IS NULL
