-- Gives an owner that has had no turn its first.
-- $1 owner.
INSERT INTO owner_turn (owner, vtime) VALUES ($1, 0) ON CONFLICT (owner) DO NOTHING
