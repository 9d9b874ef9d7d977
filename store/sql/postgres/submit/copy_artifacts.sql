-- Gives results that were copied the tables of those that they were copied from.
-- $1 keys of those and of these, hexadecimal digits: a JSON array of pairs.
INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count, expired)
SELECT decode(pair ->> 1, 'hex'), name, media_type, blob, bytes, row_count, expired
FROM json_array_elements($1::json) AS pair JOIN artifact ON work_key = decode(pair ->> 0, 'hex')
ON CONFLICT (work_key, name) DO NOTHING
