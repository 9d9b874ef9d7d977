ALTER TABLE sweep ADD COLUMN paused INTEGER NOT NULL DEFAULT 0;
-- A JSON array of texts.
ALTER TABLE sweep ADD COLUMN tags TEXT NOT NULL DEFAULT '[]';
-- The requests by which points were added later, a JSON array.
ALTER TABLE sweep ADD COLUMN appended TEXT NOT NULL DEFAULT '[]';
-- The sweep wants its points computed though they have results.
ALTER TABLE sweep ADD COLUMN refreshes INTEGER NOT NULL DEFAULT 0;

-- Wanted by paused sweeps only: not handed out until one of them goes on.
ALTER TABLE work ADD COLUMN held INTEGER NOT NULL DEFAULT 0;
