-- Deletes the scenarios that no work item changes any more.
DELETE FROM scenario WHERE NOT EXISTS (SELECT 1 FROM work WHERE work.base = scenario.hash)
