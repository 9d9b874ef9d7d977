-- name: NOW
-- The time: milliseconds since the epoch.
SELECT now FROM clock
