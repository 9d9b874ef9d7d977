-- What must be known of a sweep to add points to it.
-- $1 sweep.
-- Gives: owner, priority, number of points, whether it is cancelled, whether it is paused.
SELECT owner, priority, points, cancelled, paused FROM sweep WHERE id = $1 AND hidden IS NULL
