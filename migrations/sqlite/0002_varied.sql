-- Names of the parameters that a sweep varies, in the order of its request: lists of sweeps show them without reading the requests,
-- which may be megabytes long.
ALTER TABLE sweep ADD COLUMN varied TEXT NOT NULL DEFAULT '[]';

UPDATE sweep SET varied = (
    SELECT json_group_array(key)
    FROM (SELECT key FROM json_each(request, '$.axes') UNION ALL SELECT key FROM json_each(request, '$.points[0]')));
