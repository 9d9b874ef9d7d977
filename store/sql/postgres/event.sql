-- name: LIST
-- Events of a sweep, oldest first.
-- $1 sweep, $2 number before the first event, $3 largest number of rows.
-- Returns: number, new state, work item, time, ordinals of its points and of those that it verifies, comma-separated.
SELECT seq, kind, work_key, at,
       (SELECT string_agg(p.ordinal::text, ',' ORDER BY p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND NOT p.verifies),
       (SELECT string_agg(p.ordinal::text, ',' ORDER BY p.ordinal) FROM point p
        WHERE p.work_key = event.work_key AND p.sweep_id = event.sweep_id AND p.verifies)
FROM event
WHERE sweep_id = $1 AND seq > $2
ORDER BY seq LIMIT $3

-- name: MAKE_DURABLE
-- Writes a message to the write-ahead log. Its durable commit makes all earlier commits durable, including the asynchronous ones of
-- workers.
SELECT 1 FROM pg_logical_emit_message(true, 'drillsweep', '')
