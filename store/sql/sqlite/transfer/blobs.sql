-- A page of the blobs that rows name: of artifacts that have not expired, and of checkpoints that runs go on from.
-- ?1 name after which it begins, ?2 how many at most.
-- Gives: the blob's name.
SELECT blob FROM artifact WHERE expired IS NULL AND blob > ?1
UNION SELECT checkpoint FROM work WHERE checkpoint > ?1
ORDER BY 1 LIMIT ?2
