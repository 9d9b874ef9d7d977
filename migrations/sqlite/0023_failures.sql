-- What was given up, the latest first.
CREATE INDEX work_given_up ON work (changed) WHERE state IN ('failed', 'dead');
