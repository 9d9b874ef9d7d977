-- Marks artifacts of a name as expired. An artifact is as young as the youngest sweep that has it, and stays while a
-- pinned one has it.
-- $1 name, $2 time, $3 time after which they are too young.
UPDATE artifact SET expired = $2
WHERE name = $1 AND expired IS NULL
  AND work_key IN (SELECT work_key FROM result WHERE created <= $3)
  AND NOT EXISTS (SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
                  WHERE p.work_key = artifact.work_key AND (s.pinned OR s.created > $3))
