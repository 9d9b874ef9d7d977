-- Counts again what the planner of statements goes by: until that is done, it takes tables that have just grown for small ones, and sorts what it could
-- read in order.
ANALYZE point, work
