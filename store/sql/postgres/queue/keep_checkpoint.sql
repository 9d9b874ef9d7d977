-- Notes the blob from which the work can go on.
-- $1 work item, $2 fencing token, $3 worker, $4 blob.
UPDATE work SET checkpoint = $4
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
