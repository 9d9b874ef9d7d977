-- Artifacts of points of a sweep, by point and name.
-- $1 sweep, $2 ordinal after which the points are, $3 how many points at most.
SELECT p.ordinal, p.work_key, a.name, a.media_type, a.blob, a.bytes, a.row_count, a.expired
FROM (SELECT ordinal, work_key FROM point
      WHERE sweep_id = $1 AND NOT verifies AND ordinal > $2
        AND EXISTS (SELECT 1 FROM artifact WHERE artifact.work_key = point.work_key)
      ORDER BY ordinal LIMIT $3) AS p
JOIN artifact a ON a.work_key = p.work_key
ORDER BY p.ordinal, a.name
