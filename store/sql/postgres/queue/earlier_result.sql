-- The result that a new one takes the place of.
-- $1 work item.
-- Gives: summary, provenance, whether it disagrees with one before it.
SELECT summary, provenance, disagrees FROM result WHERE work_key = $1
