-- Deletes the scenarios that no work item changes any more: all work is gone through once.
DELETE FROM scenario WHERE hash NOT IN (SELECT DISTINCT base FROM work WHERE base IS NOT NULL)
