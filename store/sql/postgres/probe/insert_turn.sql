-- The turn of an owner that nobody is.
INSERT INTO owner_turn (owner, vtime) VALUES ('', 0)
