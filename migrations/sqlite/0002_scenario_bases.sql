-- A work item's scenario is the base of its sweep and a few changes: a hundred thousand points of one sweep share one
-- text instead of repeating it.

CREATE TABLE scenario (
    -- BLAKE3 of the text; of work stored before this table, the work's key.
    hash BLOB NOT NULL PRIMARY KEY,
    text TEXT NOT NULL
) STRICT, WITHOUT ROWID;

INSERT INTO scenario (hash, text) SELECT key, scenario FROM work;

ALTER TABLE work ADD COLUMN base BLOB REFERENCES scenario (hash);
-- What the work item has in place of the base's values: a JSON object by path.
ALTER TABLE work ADD COLUMN changes TEXT NOT NULL DEFAULT '{}';
UPDATE work SET base = key;
ALTER TABLE work DROP COLUMN scenario;
