-- Marks a result as other than the one before it.
-- $1 work item, $2 what differs, $3 provenance of the one before.
UPDATE result SET
    disagrees = true,
    provenance = jsonb_set(provenance::jsonb, '{disagreement}',
                           jsonb_build_object('differs', $2, 'earlier', $3::jsonb - 'disagreement'))::text
WHERE work_key = $1
