-- Notes that a blob is not being deleted any more.
-- ?1 blob.
DELETE FROM removal WHERE blob = ?1
