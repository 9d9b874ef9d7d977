-- Names of artifacts that have not expired.
SELECT DISTINCT name FROM artifact WHERE expired IS NULL
