-- The results of a sweep that no other one has.
-- $1 sweep.
-- Gives: their number, size of their tables [bytes].
SELECT count(*),
       coalesce(sum((SELECT sum(bytes) FROM artifact WHERE work_key = own.work_key AND expired IS NULL)), 0)::bigint
FROM (SELECT DISTINCT p.work_key FROM point p
      WHERE p.sweep_id = $1
        AND NOT EXISTS (SELECT 1 FROM point o WHERE o.work_key = p.work_key AND o.sweep_id <> $1)) AS own
JOIN result ON result.work_key = own.work_key
