-- Deletes reservations that have run out.
DELETE FROM upload WHERE expires <= (SELECT now FROM clock)
