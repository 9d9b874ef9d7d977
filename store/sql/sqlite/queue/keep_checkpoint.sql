-- Notes the blob from which the work can go on.
-- ?1 work item, ?2 attempt, ?3 worker, ?4 blob.
UPDATE work SET checkpoint = ?4
WHERE key = ?1 AND attempt = ?2 AND lease_owner = ?3 AND state = 'leased'
