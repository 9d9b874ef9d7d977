-- Counts the open work items by state.
-- Gives: waiting, queued, queued but held, leased.
SELECT count(*) FILTER (WHERE state = 'waiting'), count(*) FILTER (WHERE state = 'queued' AND NOT held),
       count(*) FILTER (WHERE state = 'queued' AND held), count(*) FILTER (WHERE state = 'leased')
FROM work WHERE is_open
