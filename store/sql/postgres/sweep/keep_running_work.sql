-- Takes the cancellation of a sweep's work back that is under way.
-- $1 sweep.
UPDATE work SET cancel_requested = false
WHERE state = 'leased' AND cancel_requested AND key IN (SELECT work_key FROM point WHERE sweep_id = $1)
