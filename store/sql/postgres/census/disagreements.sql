-- Counts the results that were recomputed and differ.
SELECT count(*) FROM result WHERE disagrees
