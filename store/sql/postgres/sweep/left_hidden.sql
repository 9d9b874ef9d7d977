-- The sweeps that have been hidden for so long that nobody works on them any more.
-- $1 how long [ms].
SELECT id FROM sweep WHERE hidden IS NOT NULL AND hidden < (SELECT now FROM clock) - $1
