-- Gives work items the results of others, which theirs are to take the place of.
-- ?1 keys of those and of these, hexadecimal digits: a JSON array of pairs.
INSERT INTO result (work_key, summary, provenance, created, disagrees, damaged)
SELECT unhex(pair.value ->> 1), summary, provenance, created, disagrees, damaged
FROM json_each(?1) AS pair
JOIN result ON work_key = unhex(pair.value ->> 0)
WHERE true
ON CONFLICT (work_key) DO NOTHING
