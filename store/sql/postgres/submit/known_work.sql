-- Those of some work items that have a result or failed.
-- $1 their keys, a JSON array of hexadecimal digits.
SELECT key FROM work
WHERE key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($1::json))
  AND (stage = 'failed' OR EXISTS (SELECT 1 FROM result WHERE work_key = work.key))
