-- Cancels the open work of a sweep that no live sweep wants: has a point of it, or verifies one by it, and of work that has
-- a result which is not damaged, asks to recompute it. What is under way ends when its worker hears of it. A result from before stays, and
-- the work is done then.
-- $1 sweep, $2 ordinal after which its points are, $3 the last.
UPDATE work SET
    cancel_requested = (state = 'leased'),
    changed = CASE state WHEN 'leased' THEN changed ELSE (SELECT now FROM clock) END,
    state = CASE WHEN state = 'leased' THEN state
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 ELSE 'cancelled' END
WHERE key IN (SELECT work_key FROM point WHERE sweep_id = $1 AND verifies IN (false, true) AND ordinal > $2 AND ordinal <= $3)
  AND is_open
  AND NOT EXISTS (SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
                  WHERE p.work_key = work.key AND NOT s.cancelled
                    AND (s.refreshes OR NOT EXISTS (SELECT 1 FROM result r WHERE r.work_key = work.key AND r.damaged IS NULL)))
