-- name: ARTIFACT_NAMES
-- Names of artifacts that have not expired.
SELECT DISTINCT name FROM artifact WHERE expired IS NULL

-- name: BEGIN_COLLECTION
-- Notes that a collection begins.
-- Gives: the time.
INSERT INTO collection (id, started) VALUES (1, (SELECT now FROM clock))
ON CONFLICT (id) DO UPDATE SET started = excluded.started
RETURNING started

-- name: BEGIN_REMOVAL
-- Notes that a blob is being deleted, unless somebody else is deleting it: nobody reserves it meanwhile.
-- $1 blob, $2 for how long that may take [ms].
-- Gives: until when that holds, by which it is told from a note that others make later; nothing if somebody else is deleting it.
INSERT INTO removal (blob, expires) VALUES ($1, (SELECT now FROM clock) + $2)
ON CONFLICT (blob) DO UPDATE SET expires = excluded.expires WHERE removal.expires <= (SELECT now FROM clock)
RETURNING expires

-- name: BLOBS_IN_USE
-- Blobs that rows name: of artifacts that have not expired, and of checkpoints that runs go on from; and those that are reserved for
-- rows to come.
SELECT blob FROM artifact WHERE expired IS NULL
UNION SELECT checkpoint FROM work WHERE checkpoint IS NOT NULL
UNION SELECT blob FROM upload WHERE expires > (SELECT now FROM clock)

-- name: DELETE_EVENTS
-- Deletes old events.
-- $1 time up to which.
DELETE FROM event WHERE at <= $1

-- name: DELETE_IDEMPOTENCY_KEYS
-- Deletes old idempotency keys.
-- $1 time up to which.
DELETE FROM idempotency WHERE created <= $1

-- name: DELETE_REMOVALS
-- Deletes what is left of deletions that were broken off.
DELETE FROM removal WHERE expires <= (SELECT now FROM clock)

-- name: DELETE_RESERVATIONS
-- Deletes reservations that have run out.
DELETE FROM upload WHERE expires <= (SELECT now FROM clock)

-- name: DELETE_RESULTS
-- Deletes the results that no sweep has any more; their artifacts go with them.
DELETE FROM result WHERE NOT EXISTS (SELECT 1 FROM point WHERE point.work_key = result.work_key)

-- name: DELETE_SESSIONS
-- Deletes sessions that have expired.
DELETE FROM session WHERE expires <= (SELECT now FROM clock)

-- name: DELETE_SWEEPS
-- Deletes the finished sweeps whose time has come; their points, events, requests and idempotency keys go with them.
-- $1 time.
DELETE FROM sweep WHERE NOT pinned AND expires <= $1 AND finished IS NOT NULL

-- name: DELETE_TURNS
-- Deletes the turns of owners without open work: who comes back begins as one who was idle, and idle time is not saved up.
DELETE FROM owner_turn WHERE NOT EXISTS (SELECT 1 FROM work WHERE work.owner = owner_turn.owner AND is_open)

-- name: DELETE_WORK
-- Deletes the final work items that no sweep has any more.
DELETE FROM work
WHERE NOT is_open
  AND NOT EXISTS (SELECT 1 FROM point WHERE point.work_key = work.key)
  AND NOT EXISTS (SELECT 1 FROM result WHERE result.work_key = work.key)

-- name: DELETE_WORKERS
-- Deletes workers that have been silent for long.
-- $1 time up to which.
DELETE FROM worker WHERE last_seen <= $1

-- name: END_COLLECTION
-- Notes that a collection has ended.
-- $1 what it deleted, JSON.
UPDATE collection SET ended = (SELECT now FROM clock), deleted = $1 WHERE id = 1

-- name: END_REMOVAL
-- Notes that a blob is not being deleted any more.
-- $1 blob, $2 until when the note of it holds.
DELETE FROM removal WHERE blob = $1 AND expires = $2

-- name: EXPIRE_ARTIFACTS
-- Marks artifacts of a name as expired. An artifact is as young as the youngest sweep that has it, and stays while a
-- pinned one has it.
-- $1 name, $2 time, $3 time after which they are too young.
UPDATE artifact SET expired = $2
WHERE name = $1 AND expired IS NULL
  AND work_key IN (SELECT work_key FROM result WHERE created <= $3)
  AND NOT EXISTS (SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
                  WHERE p.work_key = artifact.work_key AND (s.pinned OR s.created > $3))

-- name: IS_BLOB_IN_USE
-- Whether a row names a blob, as in `BLOBS_IN_USE`, or one will: while it is reserved.
-- $1 blob.
SELECT EXISTS (SELECT 1 FROM artifact WHERE blob = $1 AND expired IS NULL)
    OR EXISTS (SELECT 1 FROM work WHERE checkpoint = $1)
    OR EXISTS (SELECT 1 FROM upload WHERE blob = $1 AND expires > (SELECT now FROM clock))

-- name: LAST_COLLECTION
-- The last collection.
-- Gives: when it began, when one ended last, what that deleted, JSON.
SELECT started, ended, deleted FROM collection WHERE id = 1
