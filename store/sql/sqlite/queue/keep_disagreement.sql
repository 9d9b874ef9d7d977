-- Marks a result as one of which another has been seen, though it agrees with the one before it.
-- ?1 work item, ?2 provenance of the one before.
UPDATE result SET
    disagrees = 1,
    provenance = json_set(provenance, '$.disagreement', json_extract(?2, '$.disagreement'))
WHERE work_key = ?1
