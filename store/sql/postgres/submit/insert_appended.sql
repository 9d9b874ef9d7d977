-- Notes a request by which points were added to a sweep, after those before it.
-- $1 sweep, $2 request.
INSERT INTO appended (sweep_id, number, request)
SELECT $1, coalesce(max(number), 0) + 1, $2 FROM appended WHERE sweep_id = $1
