-- Up to which point the work of a cancelled sweep is cancelled.
-- $1 sweep.
-- Gives: the ordinal, number of points; nothing once all of it is.
SELECT cancelled_to, points FROM sweep WHERE id = $1 AND cancelled_to IS NOT NULL
