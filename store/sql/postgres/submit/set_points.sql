-- Sets the number of a sweep's points.
-- $1 sweep, $2 number.
UPDATE sweep SET points = $2, version = version + 1, revision = revision + 1 WHERE id = $1
