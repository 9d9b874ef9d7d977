-- Stores a result.
-- $1 work item, $2 summary, $3 provenance, $4 time.
INSERT INTO result (work_key, summary, provenance, created) VALUES ($1, $2, $3, $4)
