-- Those of some work items that are final and that sweeps of other owners have.
-- $1 their keys, a JSON array of hexadecimal digits; $2 the owner.
SELECT key FROM work
WHERE key IN (SELECT decode(value, 'hex') FROM json_array_elements_text($1::json))
  AND state IN ('done', 'failed', 'dead')
  AND EXISTS (SELECT 1 FROM point JOIN sweep ON sweep.id = point.sweep_id
              WHERE point.work_key = work.key AND sweep.owner <> $2)
