-- Stores an artifact of a result.
-- $1 work item, $2 name, $3 media type, $4 blob, $5 its size, $6 rows of the table.
INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count) VALUES ($1, $2, $3, $4, $5, $6)
