-- Deletes the turns of owners without open work: who comes back begins as one who was idle, and idle time is not saved up.
DELETE FROM owner_turn WHERE NOT EXISTS (SELECT 1 FROM work WHERE work.owner = owner_turn.owner AND is_open)
