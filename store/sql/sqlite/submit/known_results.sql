-- Counts those of some work items that have a result which is not damaged.
-- ?1 their keys, a JSON array of hexadecimal digits.
SELECT count(*) FROM result WHERE work_key IN (SELECT unhex(value) FROM json_each(?1)) AND damaged IS NULL
