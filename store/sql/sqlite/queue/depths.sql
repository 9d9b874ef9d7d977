-- Counts the open work items by state.
-- Gives: waiting, queued, queued but held, leased.
SELECT coalesce(sum(state = 'waiting'), 0), coalesce(sum(state = 'queued' AND held = 0), 0),
       coalesce(sum(state = 'queued' AND held <> 0), 0), coalesce(sum(state = 'leased'), 0)
FROM work WHERE is_open
