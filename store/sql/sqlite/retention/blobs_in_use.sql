-- Blobs that rows name: of artifacts that have not expired, and of checkpoints that runs go on from; and those that are reserved for
-- rows to come.
SELECT blob FROM artifact WHERE expired IS NULL
UNION SELECT checkpoint FROM work WHERE checkpoint IS NOT NULL
UNION SELECT blob FROM upload WHERE expires > (SELECT now FROM clock)
