-- A pinned sweep keeps all that belongs to it.
ALTER TABLE sweep ADD COLUMN pinned INTEGER NOT NULL DEFAULT 0;
-- When the sweep is to be deleted, once all its points are final and unless it is pinned.
ALTER TABLE sweep ADD COLUMN expires INTEGER;
-- When the artifact's blob was given up; its row tells that there was one.
ALTER TABLE artifact ADD COLUMN expired INTEGER;
