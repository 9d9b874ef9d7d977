-- What is wrong with the database's indexes, a line each: those that a build left invalid. The server itself checks its pages where
-- its data directory was made with checksums.
SELECT format('index %s is invalid', indexrelid::regclass) FROM pg_index
WHERE NOT indisvalid AND indrelid IN (SELECT oid FROM pg_class WHERE relnamespace = current_schema()::regnamespace)
