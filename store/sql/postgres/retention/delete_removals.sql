-- Deletes what is left of deletions that were broken off.
DELETE FROM removal WHERE expires <= (SELECT now FROM clock)
