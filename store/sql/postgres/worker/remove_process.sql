-- Removes the workers of a process that is gone.
-- $1 host, $2 process.
DELETE FROM worker WHERE host = $1 AND process = $2
