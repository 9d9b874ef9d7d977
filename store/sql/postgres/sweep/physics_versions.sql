-- Versions of the numbers of some sweeps. All points of a sweep are of one: the first tells.
-- $1 the sweeps, a JSON array.
-- Gives: sweep, version; nothing of sweeps that are not there.
SELECT id, physics_version FROM (
    SELECT ids.value AS id,
           (SELECT w.physics_version FROM point p JOIN work w ON w.key = p.work_key
            WHERE p.sweep_id = ids.value AND NOT p.verifies ORDER BY p.ordinal LIMIT 1) AS physics_version
    FROM json_array_elements_text($1::json) AS ids (value)) AS versions
WHERE physics_version IS NOT NULL
