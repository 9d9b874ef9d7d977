-- Asks for the end of what is under way for a sweep and no live sweep wants, as `cancel_work` does for all of its work.
-- $1 sweep.
UPDATE work SET cancel_requested = true
WHERE state = 'leased' AND NOT cancel_requested
  AND EXISTS (SELECT 1 FROM point WHERE work_key = work.key AND sweep_id = $1)
  AND NOT EXISTS (SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
                  WHERE p.work_key = work.key AND NOT s.cancelled
                    AND (s.refreshes
                         OR NOT EXISTS (SELECT 1 FROM result r WHERE r.work_key = work.key AND r.damaged IS NULL)))
