-- Those of some blobs that are not reserved, or not any more.
-- $1 their names, a JSON array.
-- Each is looked up by itself: as a join it would go through all reservations.
SELECT value FROM json_array_elements_text($1::json) AS names (value)
WHERE coalesce((SELECT expires FROM upload WHERE blob = value), 0) <= (SELECT now FROM clock)
