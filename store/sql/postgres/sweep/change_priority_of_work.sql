-- Gives the open work of a sweep the priority of the most urgent live sweep that has it.
-- $1 sweep.
UPDATE work SET
    priority = coalesce((SELECT max(s.priority) FROM point p JOIN sweep s ON s.id = p.sweep_id
                         WHERE p.work_key = work.key AND NOT s.cancelled), priority)
WHERE key IN (SELECT work_key FROM point WHERE sweep_id = $1) AND is_open
