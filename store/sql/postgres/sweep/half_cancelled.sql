-- The sweeps whose work is not all cancelled yet.
SELECT id FROM sweep WHERE cancelled_to IS NOT NULL
