-- Names of the parameters that a sweep varies, in the order of its request: lists of sweeps show them without reading the requests,
-- which may be megabytes long.
ALTER TABLE sweep ADD COLUMN varied TEXT NOT NULL DEFAULT '[]';

UPDATE sweep SET varied = (
    SELECT coalesce(json_agg(key), '[]')::text
    FROM (SELECT json_object_keys(request::json -> 'axes') AS key
          UNION ALL SELECT json_object_keys(request::json -> 'points' -> 0)) AS swept);
