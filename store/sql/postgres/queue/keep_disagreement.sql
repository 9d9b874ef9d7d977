-- Marks a result as one of which another has been seen, though it agrees with the one before it.
-- $1 work item, $2 provenance of the one before.
UPDATE result SET
    disagrees = true,
    provenance = jsonb_set(provenance::jsonb, '{disagreement}', $2::jsonb -> 'disagreement')::text
WHERE work_key = $1
