-- name: MARKS
-- How far every sweep has come.
-- Gives: sweep, version, whether it is unfinished.
SELECT id, version, finished IS NULL FROM sweep WHERE hidden IS NULL

-- name: SINCE
-- Sweeps that are unfinished, or of which a point has changed since a time, the oldest first.
-- $1 the time [ms since the epoch].
SELECT id FROM sweep
WHERE hidden IS NULL
  AND (finished IS NULL OR finished >= $1 OR created >= $1
       OR (SELECT at FROM event WHERE sweep_id = sweep.id ORDER BY seq DESC LIMIT 1) >= $1)
ORDER BY id
