-- Nothing: there, statements are no messages, and it is done step by step.
-- ?1 work item, ?2 fencing token, ?3 worker, ?4 summary, ?5 provenance, ?6 artifacts (a JSON array of objects as in the table), ?7 length of the
-- lease [ms], ?8 version of the numbers.
-- Gives: nothing.
SELECT '', NULL, NULL, NULL, NULL, NULL WHERE coalesce(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8) IS NULL
