-- Those of some work items that a sweep has among its points.
-- $1 sweep, $2 their keys, a JSON array of hexadecimal digits.
SELECT work_key FROM point
WHERE work_key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($2::json)) AND sweep_id = $1 AND NOT verifies
