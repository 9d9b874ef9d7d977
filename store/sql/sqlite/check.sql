-- name: PAGES
-- Problems of the database's pages and indexes, a line each; `ok` without any.
PRAGMA integrity_check

-- name: REFERENCES
-- Rows with a dangling reference.
-- Returns: table of the row, table of the missing row.
SELECT "table", parent FROM pragma_foreign_key_check
