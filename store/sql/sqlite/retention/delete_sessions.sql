-- Deletes sessions that have expired.
DELETE FROM session WHERE expires <= (SELECT now FROM clock)
