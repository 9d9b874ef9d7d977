-- Computed anew, it came out otherwise than before, or one before it did: the same numbers are promised. What differed is in
-- its provenance.
ALTER TABLE result ADD COLUMN disagrees INTEGER NOT NULL DEFAULT 0;
CREATE INDEX result_disagrees ON result (work_key) WHERE disagrees <> 0;
