-- What is wrong with the database's pages and indexes, a line each; `ok` where nothing is.
PRAGMA integrity_check
