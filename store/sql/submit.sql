-- name: APPENDED
-- Requests by which points were added to a sweep, latest first.
-- $1 sweep, $2 largest number of rows, $3 largest length of all of them [bytes].
SELECT request FROM appended
JOIN (SELECT number, sum(octet_length(request)) OVER (ORDER BY number DESC) AS bytes FROM appended WHERE sweep_id = $1) AS latest
  ON latest.number = appended.number
WHERE sweep_id = $1 AND bytes <= $3 ORDER BY appended.number DESC LIMIT $2

-- name: APPENDED_BYTES
-- Length of all requests by which points were added to a sweep [bytes].
-- $1 sweep.
SELECT CAST(coalesce(sum(octet_length(request)), 0) AS bigint) FROM appended WHERE sweep_id = $1

-- name: EXTENDED_SWEEP
-- Data needed to add points to a sweep.
-- $1 sweep.
-- Returns: owner, priority, number of points, true if it is cancelled, true if it is paused.
SELECT owner, priority, points, cancelled, paused FROM sweep WHERE id = $1 AND hidden IS NULL

-- name: INSERT_APPENDED
-- Stores a request by which points were added to a sweep, after earlier ones.
-- $1 sweep, $2 request.
INSERT INTO appended (sweep_id, number, request)
SELECT $1, coalesce(max(number), 0) + 1, $2 FROM appended WHERE sweep_id = $1

-- name: INSERT_IDEMPOTENCY_KEY
-- Stores the use of an idempotency key.
-- $1 owner, $2 key, $3 hash of the request's body, $4 sweep, $5 time.
INSERT INTO idempotency (owner, key, body_hash, sweep_id, created) VALUES ($1, $2, $3, $4, $5)

-- name: INSERT_SCENARIO
-- Stores a scenario, unless it exists.
-- $1 hash of its text, $2 text.
INSERT INTO scenario (hash, text) VALUES ($1, $2) ON CONFLICT (hash) DO NOTHING

-- name: INSERT_SWEEP
-- Stores a sweep, hidden until it is shown (`SHOW`); its counts follow (`COUNT`).
-- $1 sweep, $2 name, $3 owner, $4 request, $5 priority, $6 number of points, $7 time, $8 tags, $9 true if its points are recomputed,
-- $10 names of its parameters.
INSERT INTO sweep (id, name, owner, request, priority, points, created, tags, refreshes, varied, hidden)
VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $7)

-- name: KEEP_HIDDEN
-- Renews the time of a hidden sweep whose points are being stored; changes nothing after the sweep was removed or cancelled.
-- $1 sweep.
UPDATE sweep SET hidden = (SELECT now FROM clock) WHERE id = $1 AND hidden IS NOT NULL AND NOT cancelled

-- name: KNOWN_SWEEP
-- Use of an idempotency key.
-- $1 owner, $2 key.
-- Returns: hash of the request's body, sweep, true if that is hidden.
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
-- Physics version of a sweep's points: that of the first, since all have the same.
-- $1 sweep.
SELECT w.physics_version FROM point p JOIN work w ON w.key = p.work_key
WHERE p.sweep_id = $1 AND p.verifies = false ORDER BY p.ordinal LIMIT 1
