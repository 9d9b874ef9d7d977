-- Those of some work items that a sweep has among its points.
-- ?1 sweep, ?2 their keys, a JSON array of hexadecimal digits.
SELECT work_key FROM point
WHERE work_key IN (SELECT unhex(value) FROM json_each(?2)) AND sweep_id = ?1 AND verifies = 0
