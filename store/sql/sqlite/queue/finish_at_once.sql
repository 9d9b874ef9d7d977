-- Nothing: there, statements are no messages, and it is done step by step.
-- ?1 work item, ?2 fencing token, ?3 worker, ?4 summary, ?5 provenance, ?6 artifacts (a JSON array of objects as in the table).
-- Gives: nothing.
SELECT '' WHERE coalesce(?1, ?2, ?3, ?4, ?5, ?6) IS NULL
