-- For how long the oldest work item that is ready has been waiting [ms].
SELECT coalesce(max(0, (SELECT now FROM clock) - min(changed)), 0) FROM work WHERE state = 'queued' AND held = 0
