-- Hides a sweep, or keeps it hidden.
-- $1 sweep.
UPDATE sweep SET hidden = (SELECT now FROM clock) WHERE id = $1
