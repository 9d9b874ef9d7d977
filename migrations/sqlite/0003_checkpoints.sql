-- The blob that a suspended run goes on from; none for one that begins at its start.
ALTER TABLE work ADD COLUMN checkpoint TEXT;
