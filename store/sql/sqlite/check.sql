-- name: PAGES
-- What is wrong with the database's pages and indexes, a line each; `ok` where nothing is.
PRAGMA integrity_check

-- name: REFERENCES
-- Rows that name another that is not there.
-- Gives: the row's table, the other's.
SELECT "table", parent FROM pragma_foreign_key_check
