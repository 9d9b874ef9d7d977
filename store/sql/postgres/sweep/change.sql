-- Changes what can be changed of a sweep.
-- $1 sweep, $2 whether the name changes, $3 name, $4 priority or none, $5 tags or none, $6 whether it is pinned, or none,
-- $7 whether the time changes at which it is deleted, $8 that time, $9 the revision that it must have, or none for any.
UPDATE sweep SET
    name = CASE WHEN $2 THEN $3 ELSE name END, priority = coalesce($4, priority),
    tags = coalesce($5, tags), pinned = coalesce($6, pinned),
    expires = CASE WHEN $7 THEN $8 ELSE expires END, version = version + 1, revision = revision + 1
WHERE id = $1 AND hidden IS NULL AND ($9 IS NULL OR revision = $9)
