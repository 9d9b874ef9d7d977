-- Notes up to which point the work of a cancelled sweep is cancelled.
-- $1 sweep, $2 the ordinal.
UPDATE sweep SET cancelled_to = CASE WHEN $2 < points THEN $2::bigint END WHERE id = $1
