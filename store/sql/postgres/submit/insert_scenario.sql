-- Stores a scenario, unless it is there.
-- $1 hash of its text, $2 text.
INSERT INTO scenario (hash, text) VALUES ($1, $2) ON CONFLICT (hash) DO NOTHING
