-- Holds back the open work of a sweep, or lets it go: it is held while no live sweep wants it that is not paused. A sweep
-- wants what it has a point of, or verifies one by, and of work that has a result which is not damaged, what it asks
-- to recompute.
-- $1 sweep, $2 ordinal after which its points are, $3 the last.
UPDATE work SET held = NOT EXISTS (
    SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
    WHERE p.work_key = work.key AND NOT s.cancelled AND NOT s.paused
      AND (s.refreshes OR NOT EXISTS (SELECT 1 FROM result r WHERE r.work_key = work.key AND r.damaged IS NULL)))
WHERE key IN (SELECT work_key FROM point WHERE sweep_id = $1 AND verifies IN (false, true) AND ordinal > $2 AND ordinal <= $3) AND is_open
