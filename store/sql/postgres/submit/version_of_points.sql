-- Version of the numbers of a sweep's points. All are of one: the first tells.
-- $1 sweep.
SELECT w.physics_version FROM point p JOIN work w ON w.key = p.work_key
WHERE p.sweep_id = $1 AND NOT p.verifies ORDER BY p.ordinal LIMIT 1
