-- How long the lease is that a worker was given or has renewed: a lease that ends later than that from now is one that was
-- given before the clock was set back. Of leases that are older than this column it is the longest that there can be.
ALTER TABLE work ADD COLUMN lease_ms INTEGER NOT NULL DEFAULT 3600000;
