-- Counts those of some work items that have a result which is not damaged.
-- $1 their keys, a JSON array of hexadecimal digits.
SELECT count(*) FROM result WHERE work_key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($1::json)) AND damaged IS NULL
