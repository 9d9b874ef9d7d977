-- Deletes the first events of a sweep that there are.
-- $1 sweep, $2 how many at most.
DELETE FROM event
WHERE sweep_id = $1 AND seq IN (SELECT seq FROM event WHERE sweep_id = $1 ORDER BY seq LIMIT $2)
