-- Stores a result, where it is the first of its work item, hands the next work item to the same worker, and does what follows from both
-- (migrations/postgres/0001_schema.sql). It commits, and is no part of a transaction.
-- $1 work item, $2 fencing token, $3 worker, $4 summary, $5 provenance, $6 artifacts (a JSON array of objects as in the table), $7 length of the
-- lease [ms], $8 version of the numbers.
-- Gives: 'done'; 'lost', the lease; 'earlier' if there is a result already; 'missing' and the name of a blob that is not reserved; and after
-- 'done' work item, fencing token, base, changes, checkpoint, if work is ready.
CALL finish_and_claim($1, $2, $3, $4, $5, $6::json, $7, $8, NULL, NULL, NULL, NULL, NULL, NULL)
