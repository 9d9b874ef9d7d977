-- name: PAGES
-- Problems of the database's indexes, a line each: indexes that an interrupted build left invalid. The server checks its pages itself if
-- its data directory has checksums.
SELECT format('index %s is invalid', indexrelid::regclass) FROM pg_index
WHERE NOT indisvalid AND indrelid IN (SELECT oid FROM pg_class WHERE relnamespace = current_schema()::regnamespace)

-- name: REFERENCES
-- Rows with a dangling reference, which the constraints exclude unless they were switched off.
-- Returns: table of the row, table of the missing row.
SELECT 'point', 'work' FROM point WHERE NOT EXISTS (SELECT 1 FROM work WHERE work.key = point.work_key)
UNION ALL
SELECT 'point', 'sweep' FROM point WHERE NOT EXISTS (SELECT 1 FROM sweep WHERE sweep.id = point.sweep_id)
UNION ALL
SELECT 'result', 'work' FROM result WHERE NOT EXISTS (SELECT 1 FROM work WHERE work.key = result.work_key)
UNION ALL
SELECT 'artifact', 'result' FROM artifact WHERE NOT EXISTS (SELECT 1 FROM result WHERE result.work_key = artifact.work_key)
UNION ALL
SELECT 'work', 'scenario' FROM work
WHERE base IS NOT NULL AND NOT EXISTS (SELECT 1 FROM scenario WHERE scenario.hash = work.base)
