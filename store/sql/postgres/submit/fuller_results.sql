-- Those of some work items that have a result with all its tables, and are not being recomputed.
-- $1 their keys, a JSON array of hexadecimal digits.
SELECT key FROM work
WHERE key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($1::json))
  AND state = 'done'
  AND NOT EXISTS (SELECT 1 FROM result WHERE work_key = work.key AND damaged IS NOT NULL)
  AND NOT EXISTS (SELECT 1 FROM artifact WHERE work_key = work.key AND expired IS NOT NULL)
