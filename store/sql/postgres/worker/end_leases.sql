-- Ends the leases of a process that is gone: the next look at them sees them as run out.
-- $1 host, $2 process, $3 what is known of its end, or null.
UPDATE work SET lease_until = (SELECT now FROM clock) - 1, worker_note = coalesce($3, worker_note)
WHERE state = 'leased' AND lease_owner IN (SELECT id FROM worker WHERE host = $1 AND process = $2)
