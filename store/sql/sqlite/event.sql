-- name: LIST
-- Events of a sweep, oldest first.
-- $1 sweep, $2 number before the first event, $3 largest number of rows.
-- Returns: number, new state, work item, time, ordinals of its points and of those that it verifies, comma-separated.
SELECT seq, kind, work_key, at,
       (SELECT group_concat(p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND p.verifies = 0),
       (SELECT group_concat(p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND p.verifies = 1)
FROM event
WHERE sweep_id = $1 AND seq > $2
ORDER BY seq LIMIT $3

-- name: MAKE_DURABLE
-- No operation: a commit that other processes see survives a crash of its process.
SELECT 1 WHERE false
