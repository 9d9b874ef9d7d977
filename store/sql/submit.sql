-- name: APPENDED
-- The requests by which points were added to a sweep, the latest first.
-- $1 sweep, $2 how many at most.
SELECT request FROM appended WHERE sweep_id = $1 ORDER BY number DESC LIMIT $2

-- name: EXTENDED_SWEEP
-- What must be known of a sweep to add points to it.
-- $1 sweep.
-- Gives: owner, priority, number of points, whether it is cancelled, whether it is paused.
SELECT owner, priority, points, cancelled, paused FROM sweep WHERE id = $1 AND hidden IS NULL

-- name: INSERT_APPENDED
-- Notes a request by which points were added to a sweep, after those before it.
-- $1 sweep, $2 request.
INSERT INTO appended (sweep_id, number, request)
SELECT $1, coalesce(max(number), 0) + 1, $2 FROM appended WHERE sweep_id = $1

-- name: INSERT_IDEMPOTENCY_KEY
-- Notes what an idempotency key was used for.
-- $1 owner, $2 key, $3 hash of the request's body, $4 sweep, $5 time.
INSERT INTO idempotency (owner, key, body_hash, sweep_id, created) VALUES ($1, $2, $3, $4, $5)

-- name: INSERT_SCENARIO
-- Stores a scenario, unless it is there.
-- $1 hash of its text, $2 text.
INSERT INTO scenario (hash, text) VALUES ($1, $2) ON CONFLICT (hash) DO NOTHING

-- name: INSERT_SWEEP
-- Stores a sweep, hidden until it is shown (`SHOW`); its counts follow (`COUNT`).
-- $1 sweep, $2 name, $3 owner, $4 request, $5 priority, $6 number of points, $7 time, $8 tags, $9 whether it wants its
-- points recomputed.
INSERT INTO sweep (id, name, owner, request, priority, points, created, tags, refreshes, hidden)
VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $7)

-- name: KEEP_HIDDEN
-- Notes that points of a hidden sweep are being stored; nothing is changed once it was taken away.
-- $1 sweep.
UPDATE sweep SET hidden = (SELECT now FROM clock) WHERE id = $1 AND hidden IS NOT NULL AND NOT cancelled

-- name: KNOWN_SWEEP
-- What an idempotency key was used for.
-- $1 owner, $2 key.
-- Gives: hash of the request's body, sweep, whether that is hidden.
SELECT body_hash, sweep_id, hidden IS NOT NULL FROM idempotency JOIN sweep ON id = sweep_id
WHERE idempotency.owner = $1 AND key = $2

-- name: SET_POINTS
-- Sets the number of a sweep's points.
-- $1 sweep, $2 number.
UPDATE sweep SET points = $2, version = version + 1, revision = revision + 1 WHERE id = $1

-- name: SHOW
-- Shows a sweep whose points are all stored.
-- $1 sweep.
UPDATE sweep SET hidden = NULL WHERE id = $1 AND hidden IS NOT NULL AND NOT cancelled

-- name: VERSION_OF_POINTS
-- Version of the numbers of a sweep's points. All are of one: the first tells.
-- $1 sweep.
SELECT w.physics_version FROM point p JOIN work w ON w.key = p.work_key
WHERE p.sweep_id = $1 AND p.verifies = false ORDER BY p.ordinal LIMIT 1
