-- Tells those who watch a cancelled sweep that it is done with what goes on for others.
-- $1 sweep, $2 ordinal after which its points are, $3 the last.
INSERT INTO event (sweep_id, seq, kind, work_key, at)
SELECT s.id, s.version + row_number() OVER (ORDER BY shared.key), 'cancelled', shared.key, (SELECT now FROM clock)
FROM (SELECT DISTINCT w.key FROM point p JOIN work w ON w.key = p.work_key
      WHERE p.sweep_id = $1 AND p.verifies IN (false, true) AND p.ordinal > $2 AND p.ordinal <= $3 AND w.is_open AND w.stage_of_cancelled = 'cancelled') AS shared
JOIN sweep s ON s.id = $1
