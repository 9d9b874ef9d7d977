-- Marks a sweep as paused, or not any more.
-- $1 sweep, $2 whether it is paused.
UPDATE sweep SET paused = $2, version = version + 1, revision = revision + 1 WHERE id = $1 AND hidden IS NULL
