-- Those of some blobs that are not reserved, or not any more.
-- $1 their names, a JSON array.
SELECT value FROM json_array_elements_text($1::json) AS names (value)
WHERE NOT EXISTS (SELECT 1 FROM upload WHERE blob = value AND expires > (SELECT now FROM clock))
