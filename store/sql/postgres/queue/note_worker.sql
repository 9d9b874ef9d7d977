-- Notes what is known of the worker that has the work.
-- $1 work item, $2 fencing token, $3 worker, $4 the note.
UPDATE work SET worker_note = $4
WHERE key = $1 AND fencing_token = $2 AND lease_owner = $3 AND state = 'leased'
