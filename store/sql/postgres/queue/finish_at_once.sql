-- Ends a lease with a result, if that is the first of its work item: one statement instead of several, each a message to the server and
-- back (migrations/postgres/0001_schema.sql).
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table).
-- Gives: what came of it; nothing if it has to be done step by step.
SELECT outcome FROM finish_work($1, $2, $3, $4, $5, $6::json) AS done (outcome) WHERE outcome <> 'earlier'
