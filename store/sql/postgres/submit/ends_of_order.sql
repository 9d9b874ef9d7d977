-- The first and the last place that is taken in an owner's order; 0 where none is.
-- $1 owner.
SELECT coalesce((SELECT min(vtime) FROM work WHERE owner = $1 AND is_open), 0),
       coalesce((SELECT max(vtime) FROM work WHERE owner = $1 AND is_open), 0)
