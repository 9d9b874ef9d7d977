-- Marks a result as other than the one before it.
-- ?1 work item, ?2 what differs, ?3 provenance of the one before.
UPDATE result SET
    disagrees = 1,
    provenance = json_set(provenance, '$.disagreement',
                          json_object('differs', ?2, 'earlier', json_remove(?3, '$.disagreement')))
WHERE work_key = ?1
