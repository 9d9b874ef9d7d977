-- Artifacts of a result, by name.
-- $1 work item.
SELECT name, media_type, blob, bytes, row_count, expired FROM artifact WHERE work_key = $1 ORDER BY name
