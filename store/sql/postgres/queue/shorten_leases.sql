-- Cuts leases that end later than they could, had they begun now, to their whole length from now.
UPDATE work SET lease_until = (SELECT now FROM clock) + lease_ms
WHERE state = 'leased' AND lease_until > (SELECT now FROM clock) + lease_ms
