-- Hands out the next work item: of the owner whose turn it is the most urgent, of these the first in the order asked for
-- (migrations/postgres/0001_schema.sql).
-- $1 worker, $2 length of the lease [ms], $3 version of the numbers.
-- Gives: work item, fencing token, base, changes, checkpoint; nothing if no work is ready.
SELECT key, fencing_token, base, changes, checkpoint FROM claim_work($1, $2, $3)
