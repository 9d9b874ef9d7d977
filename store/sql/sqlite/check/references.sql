-- Rows that name another that is not there.
-- Gives: the row's table, the other's.
SELECT "table", parent FROM pragma_foreign_key_check
