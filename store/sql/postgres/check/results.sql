-- Counts the results.
SELECT count(*) FROM result
