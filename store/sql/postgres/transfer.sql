-- name: COLUMNS
-- Stored columns of a table, by name, without those of `work` that its trigger derives from the state.
-- $1 table.
-- Returns: name, type, position in the primary key from 1, or 0.
SELECT attname::text,
       CASE atttypid WHEN 'bigint'::regtype THEN 'integer' WHEN 'boolean'::regtype THEN 'flag'
                     WHEN 'double precision'::regtype THEN 'real' WHEN 'bytea'::regtype THEN 'bytes' ELSE 'text' END,
       coalesce((SELECT place FROM pg_index, unnest(indkey) WITH ORDINALITY AS member (number, place)
                 WHERE indrelid = attrelid AND indisprimary AND number = attnum), 0)
FROM pg_attribute
WHERE attrelid = to_regclass($1) AND attnum > 0 AND NOT attisdropped AND NOT ($1 = 'work' AND attname IN ('stage', 'is_open', 'stage_of_cancelled'))
ORDER BY attname COLLATE "C"
