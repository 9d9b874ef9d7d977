-- Notes that points of a hidden sweep are being stored; nothing is changed once it was taken away.
-- $1 sweep.
UPDATE sweep SET hidden = (SELECT now FROM clock) WHERE id = $1 AND hidden IS NOT NULL AND NOT cancelled
