-- Notes that a blob is not being deleted any more.
-- ?1 blob, ?2 until when the note of it holds.
DELETE FROM removal WHERE blob = ?1 AND expires = ?2
