-- Blobs that rows name: of artifacts that have not expired, and of checkpoints that runs go on from.
SELECT blob FROM artifact WHERE expired IS NULL
UNION SELECT checkpoint FROM work WHERE checkpoint IS NOT NULL
