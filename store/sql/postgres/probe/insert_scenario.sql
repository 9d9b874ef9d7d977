-- The scratch scenario.
-- $1 its hash.
INSERT INTO scenario (hash, text) VALUES ($1, '')
