-- Whether a base is in use: the garbage collector asks it of every base, and so does the reference when one is deleted.
CREATE INDEX work_by_base ON work (base);
