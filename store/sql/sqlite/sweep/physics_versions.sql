-- Versions of the numbers of some sweeps. All points of a sweep are of one: the first tells.
-- ?1 the sweeps, a JSON array.
-- Gives: sweep, version; nothing of sweeps that are not there.
SELECT id, physics_version FROM (
    SELECT value AS id,
           (SELECT w.physics_version FROM point p JOIN work w ON w.key = p.work_key
            WHERE p.sweep_id = json_each.value AND p.verifies = 0 ORDER BY p.ordinal LIMIT 1) AS physics_version
    FROM json_each(?1))
WHERE physics_version IS NOT NULL
