-- name: COLUMNS
-- Stored columns of a table, by name.
-- $1 table.
-- Returns: name, type, position in the primary key from 1, or 0.
SELECT name, CASE type WHEN 'INTEGER' THEN 'integer' WHEN 'REAL' THEN 'real' WHEN 'BLOB' THEN 'bytes' ELSE 'text' END, pk
FROM pragma_table_xinfo($1) WHERE hidden = 0 ORDER BY name
