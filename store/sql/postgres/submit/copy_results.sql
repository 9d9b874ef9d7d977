-- Gives work items the results of others, which theirs are to take the place of.
-- $1 keys of those and of these, hexadecimal digits: a JSON array of pairs.
INSERT INTO result (work_key, summary, provenance, created, disagrees, damaged)
SELECT decode(pair ->> 1, 'hex'), summary, provenance, created, disagrees, damaged
FROM json_array_elements($1::json) AS pair JOIN result ON work_key = decode(pair ->> 0, 'hex')
ON CONFLICT (work_key) DO NOTHING
