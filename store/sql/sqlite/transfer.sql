-- name: COLUMNS
-- The columns of a table that are stored, by their names.
-- $1 table.
-- Gives: name, what it holds, its place in the primary key from 1, or 0.
SELECT name, CASE type WHEN 'INTEGER' THEN 'integer' WHEN 'REAL' THEN 'real' WHEN 'BLOB' THEN 'bytes' ELSE 'text' END, pk
FROM pragma_table_xinfo($1) WHERE hidden = 0 ORDER BY name
