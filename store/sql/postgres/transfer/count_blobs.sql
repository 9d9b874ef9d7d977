-- How many blobs rows name: of artifacts that have not expired, and of checkpoints that runs go on from.
-- Gives: the number.
SELECT count(*) FROM (SELECT blob FROM artifact WHERE expired IS NULL
                      UNION SELECT checkpoint FROM work WHERE checkpoint IS NOT NULL) AS named
