-- The requests by which points were added to a sweep, the latest first.
-- $1 sweep, $2 how many at most.
SELECT request FROM appended WHERE sweep_id = $1 ORDER BY number DESC LIMIT $2
