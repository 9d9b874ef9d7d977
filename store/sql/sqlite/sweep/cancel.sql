-- Marks a sweep as cancelled.
-- ?1 sweep.
UPDATE sweep SET cancelled = 1, version = version + 1 WHERE id = ?1
