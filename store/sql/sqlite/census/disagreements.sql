-- Counts the results that were computed anew and came out otherwise.
SELECT count(*) FROM result WHERE disagrees <> 0
