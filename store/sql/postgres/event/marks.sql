-- How far every sweep has come.
-- Gives: sweep, version, whether it is unfinished.
SELECT id, version, finished IS NULL FROM sweep WHERE hidden IS NULL
