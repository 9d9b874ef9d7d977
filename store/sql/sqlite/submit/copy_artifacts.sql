-- Gives results that were copied the tables of those that they were copied from.
-- ?1 keys of those and of these, hexadecimal digits: a JSON array of pairs.
INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count, expired)
SELECT unhex(pair.value ->> 1), name, media_type, blob, bytes, row_count, expired
FROM json_each(?1) AS pair
JOIN artifact ON work_key = unhex(pair.value ->> 0)
WHERE true
ON CONFLICT (work_key, name) DO NOTHING
