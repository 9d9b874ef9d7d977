-- name: ARTIFACT_NAMES
-- Names of artifacts that have not expired.
SELECT DISTINCT name FROM artifact WHERE expired IS NULL

-- name: BEGIN_COLLECTION
-- Records the start of a garbage collection.
-- Returns: the time.
INSERT INTO collection (id, started) VALUES (1, (SELECT now FROM clock))
ON CONFLICT (id) DO UPDATE SET started = excluded.started
RETURNING started

-- name: BEGIN_REMOVAL
-- Locks a blob for deletion, unless another process holds the lock; a locked blob cannot be reserved.
-- $1 blob, $2 duration of the lock [ms].
-- Returns: expiry of the lock, which identifies it; nothing if another process holds it.
INSERT INTO removal (blob, expires) VALUES ($1, (SELECT now FROM clock) + $2)
ON CONFLICT (blob) DO UPDATE SET expires = excluded.expires WHERE removal.expires <= (SELECT now FROM clock)
RETURNING expires

-- name: BLOBS_IN_USE
-- Blobs in use: of unexpired artifacts, of checkpoints, and of valid reservations.
SELECT blob FROM artifact WHERE expired IS NULL
UNION SELECT checkpoint FROM work WHERE checkpoint IS NOT NULL
UNION SELECT blob FROM upload WHERE expires > (SELECT now FROM clock)

-- name: DELETE_EVENTS
-- Deletes old events.
-- $1 time of the latest to delete.
DELETE FROM event WHERE at <= $1

-- name: DELETE_IDEMPOTENCY_KEYS
-- Deletes old idempotency keys.
-- $1 time of the latest to delete.
DELETE FROM idempotency WHERE created <= $1

-- name: DELETE_REMOVALS
-- Deletes expired locks of interrupted deletions.
DELETE FROM removal WHERE expires <= (SELECT now FROM clock)

-- name: DELETE_RESERVATIONS
-- Deletes expired reservations.
DELETE FROM upload WHERE expires <= (SELECT now FROM clock)

-- name: DELETE_RESULTS
-- Deletes results without a point, with their artifacts.
DELETE FROM result WHERE NOT EXISTS (SELECT 1 FROM point WHERE point.work_key = result.work_key)

-- name: DELETE_SESSIONS
-- Deletes expired sessions.
DELETE FROM session WHERE expires <= (SELECT now FROM clock)

-- name: DELETE_SWEEPS
-- Deletes finished unpinned sweeps that have expired, with their points, events, requests and idempotency keys.
-- $1 time.
DELETE FROM sweep WHERE NOT pinned AND expires <= $1 AND finished IS NOT NULL

-- name: DELETE_TURNS
-- Deletes the turns of owners without open work: a returning owner starts like an idle one, and idle time earns no credit.
DELETE FROM owner_turn WHERE NOT EXISTS (SELECT 1 FROM work WHERE work.owner = owner_turn.owner AND is_open)

-- name: DELETE_WORK
-- Deletes final work items without a point and without a result.
DELETE FROM work
WHERE NOT is_open
  AND NOT EXISTS (SELECT 1 FROM point WHERE point.work_key = work.key)
  AND NOT EXISTS (SELECT 1 FROM result WHERE result.work_key = work.key)

-- name: DELETE_WORKERS
-- Deletes workers without a recent heartbeat.
-- $1 latest heartbeat to delete.
DELETE FROM worker WHERE last_seen <= $1

-- name: END_COLLECTION
-- Records the end of a garbage collection.
-- $1 numbers deleted, JSON.
UPDATE collection SET ended = (SELECT now FROM clock), deleted = $1 WHERE id = 1

-- name: END_REMOVAL
-- Releases the lock of a blob's deletion.
-- $1 blob, $2 expiry of the lock.
DELETE FROM removal WHERE blob = $1 AND expires = $2

-- name: EXPIRE_ARTIFACTS
-- Marks artifacts of a name as expired, unless the result or a sweep with its point is younger than the limit, or such a sweep is pinned.
-- $1 name, $2 time, $3 creation time of the youngest to expire.
UPDATE artifact SET expired = $2
WHERE name = $1 AND expired IS NULL
  AND work_key IN (SELECT work_key FROM result WHERE created <= $3)
  AND NOT EXISTS (SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
                  WHERE p.work_key = artifact.work_key AND (s.pinned OR s.created > $3))

-- name: IS_BLOB_IN_USE
-- True if a blob is in use, as in `BLOBS_IN_USE`.
-- $1 blob.
SELECT EXISTS (SELECT 1 FROM artifact WHERE blob = $1 AND expired IS NULL)
    OR EXISTS (SELECT 1 FROM work WHERE checkpoint = $1)
    OR EXISTS (SELECT 1 FROM upload WHERE blob = $1 AND expires > (SELECT now FROM clock))

-- name: LAST_COLLECTION
-- The last garbage collection.
-- Returns: start, end of the last that ended, numbers that it deleted (JSON).
SELECT started, ended, deleted FROM collection WHERE id = 1
