-- name: LIST
-- Events of a sweep, oldest first.
-- $1 sweep, $2 number after which they are, $3 how many at most.
-- Gives: number, new state, work item, time, ordinals of its points and of those that it verifies, by commas.
SELECT seq, kind, work_key, at,
       (SELECT string_agg(p.ordinal::text, ',' ORDER BY p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND NOT p.verifies),
       (SELECT string_agg(p.ordinal::text, ',' ORDER BY p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND p.verifies)
FROM event
WHERE sweep_id = $1 AND seq > $2
ORDER BY seq LIMIT $3

-- name: MAKE_DURABLE
-- Writes a note to the write-ahead log. Once it is committed durably, so is all that was committed before, as what workers commit is not
-- at once.
SELECT 1 FROM pg_logical_emit_message(true, 'drillsweep', '')
