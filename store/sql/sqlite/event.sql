-- name: LIST
-- Events of a sweep, oldest first.
-- $1 sweep, $2 number after which they are, $3 how many at most.
-- Gives: number, new state, work item, time, ordinals of its points and of those that it verifies, by commas.
SELECT seq, kind, work_key, at,
       (SELECT group_concat(p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND p.verifies = 0),
       (SELECT group_concat(p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND p.verifies = 1)
FROM event
WHERE sweep_id = $1 AND seq > $2
ORDER BY seq LIMIT $3

-- name: MAKE_DURABLE
-- Nothing: what one process sees, a crash of another one does not undo.
SELECT 1 WHERE false
