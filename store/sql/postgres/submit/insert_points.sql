-- Stores points of a sweep, or runs that verify some.
-- $1 sweep, $2 whether they are runs, $3 ordinals, keys of their work, hexadecimal digits, and parameters: a JSON array of
-- triples.
INSERT INTO point (sweep_id, verifies, ordinal, parameters, work_key)
SELECT $1, $2, (value ->> 0)::bigint, value ->> 2, decode(value ->> 1, 'hex') FROM json_array_elements($3::json) AS rows (value)
