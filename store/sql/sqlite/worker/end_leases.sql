-- Ends the leases of a process that is gone: the next look at them sees them as run out.
-- ?1 host, ?2 process.
UPDATE work SET lease_until = (SELECT now FROM clock) - 1
WHERE state = 'leased' AND lease_owner IN (SELECT id FROM worker WHERE host = ?1 AND process = ?2)
