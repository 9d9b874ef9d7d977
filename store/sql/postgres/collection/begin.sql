-- Notes that a collection begins.
-- Gives: the time.
INSERT INTO collection (id, started) VALUES (1, (SELECT now FROM clock))
ON CONFLICT (id) DO UPDATE SET started = excluded.started
RETURNING started
