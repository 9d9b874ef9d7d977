-- Whether a sweep may be deleted, and what goes with it.
-- $1 sweep.
-- Gives: revision, whether it is pinned, when it finished, number of points.
SELECT revision, pinned, finished, points FROM sweep WHERE id = $1 AND hidden IS NULL
