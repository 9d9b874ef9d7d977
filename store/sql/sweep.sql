-- name: CANCEL
-- Marks a sweep as cancelled, unless it is already. Its open points count as cancelled; those whose work is stopped count as running
-- again until the work has ended (`CANCEL_WORK`).
-- $1 sweep.
UPDATE sweep SET
    cancelled = true, cancelled_to = 0, version = version + 1, revision = revision + 1, finished = coalesce(finished, (SELECT now FROM clock)),
    points_cancelled = points_cancelled + points_queued + points_running, points_queued = 0, points_running = 0,
    verifications_cancelled = verifications_cancelled + verifications_queued + verifications_running,
    verifications_queued = 0, verifications_running = 0
WHERE id = $1 AND NOT cancelled

-- name: CANCEL_TO
-- Stores the last point to which the work of a cancelled sweep is cancelled; null after the last point.
-- $1 sweep, $2 the ordinal.
UPDATE sweep SET cancelled_to = CASE WHEN $2 < points THEN CAST($2 AS bigint) END WHERE id = $1

-- name: CANCEL_WORK
-- Cancels the open work of a sweep that no live sweep needs. A live sweep needs work of its points and verification runs that has no
-- undamaged result, or whose results it recomputes. Leased work ends at its worker's next renewal. If the work ends here and has an
-- earlier result, its state becomes done.
-- $1 sweep, $2 ordinal before the first point, $3 ordinal of the last.
UPDATE work SET
    cancel_requested = (state = 'leased'),
    changed = CASE state WHEN 'leased' THEN changed ELSE (SELECT now FROM clock) END,
    state = CASE WHEN state = 'leased' THEN state
                 WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work.key) THEN 'done'
                 ELSE 'cancelled' END
WHERE key IN (SELECT work_key FROM point WHERE sweep_id = $1 AND verifies IN (false, true) AND ordinal > $2 AND ordinal <= $3)
  AND is_open
  AND NOT EXISTS (SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
                  WHERE p.work_key = work.key AND NOT s.cancelled
                    AND (s.refreshes OR NOT EXISTS (SELECT 1 FROM result r WHERE r.work_key = work.key AND r.damaged IS NULL)))

-- name: CANCELLED_TO
-- Last point to which the work of a cancelled sweep is cancelled.
-- $1 sweep.
-- Returns: the ordinal, number of points; nothing once all of it is.
SELECT cancelled_to, points FROM sweep WHERE id = $1 AND cancelled_to IS NOT NULL

-- name: CHANGE
-- Changes the editable fields of a sweep.
-- $1 sweep, $2 true if the name changes, $3 name, $4 priority or null, $5 tags or null, $6 pin or null, $7 true if the expiry changes,
-- $8 expiry, $9 required revision, or null for any.
UPDATE sweep SET
    name = CASE WHEN $2 THEN $3 ELSE name END, priority = coalesce($4, priority),
    tags = coalesce($5, tags), pinned = coalesce($6, pinned),
    expires = CASE WHEN $7 THEN $8 ELSE expires END, version = version + 1, revision = revision + 1
WHERE id = $1 AND hidden IS NULL AND ($9 IS NULL OR revision = $9)

-- name: CHANGE_PRIORITY_OF_WORK
-- Sets the priority of a sweep's open work to the highest of the live sweeps that have it.
-- $1 sweep.
UPDATE work SET
    priority = coalesce((SELECT max(s.priority) FROM point p JOIN sweep s ON s.id = p.sweep_id
                         WHERE p.work_key = work.key AND NOT s.cancelled), priority)
WHERE key IN (SELECT work_key FROM point WHERE sweep_id = $1) AND is_open

-- name: COUNT_EVENTS
-- Increases the version of a sweep by a batch of stored events.
-- $1 sweep, $2 their number; a finished sweep gets one more.
UPDATE sweep SET version = version + $2 + CASE WHEN finished IS NULL THEN 0 ELSE 1 END WHERE id = $1

-- name: DELETABLE
-- Data for the deletion of a sweep.
-- $1 sweep.
-- Returns: revision, true if it is pinned, time of its end, number of points.
SELECT revision, pinned, finished, points FROM sweep WHERE id = $1 AND hidden IS NULL

-- name: DELETE
-- Deletes a sweep, with its points, events, requests and idempotency keys.
-- $1 sweep.
DELETE FROM sweep WHERE id = $1

-- name: DELETE_EVENTS
-- Deletes the first events of a sweep.
-- $1 sweep, $2 largest number of rows.
DELETE FROM event
WHERE sweep_id = $1 AND seq IN (SELECT seq FROM event WHERE sweep_id = $1 ORDER BY seq LIMIT $2)

-- name: DELETE_POINTS
-- Deletes the first points of a sweep.
-- $1 sweep, $2 ordinal of the last to delete.
DELETE FROM point WHERE sweep_id = $1 AND verifies IN (false, true) AND ordinal <= $2

-- name: FORGET_KEYS
-- Deletes the idempotency keys of a sweep.
-- $1 sweep.
DELETE FROM idempotency WHERE sweep_id = $1

-- name: HALF_CANCELLED
-- Cancelled sweeps with work that is not cancelled yet.
SELECT id FROM sweep WHERE cancelled_to IS NOT NULL

-- name: HIDE
-- Hides a sweep, or keeps it hidden.
-- $1 sweep.
UPDATE sweep SET hidden = (SELECT now FROM clock) WHERE id = $1

-- name: HOLD_BACK
-- Holds or releases the open work of a sweep: it is held while no live unpaused sweep needs it. A sweep needs work of its points and
-- verification runs that has no undamaged result, or whose results it recomputes.
-- $1 sweep, $2 ordinal before the first point, $3 ordinal of the last.
UPDATE work SET held = NOT EXISTS (
    SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
    WHERE p.work_key = work.key AND NOT s.cancelled AND NOT s.paused
      AND (s.refreshes OR NOT EXISTS (SELECT 1 FROM result r WHERE r.work_key = work.key AND r.damaged IS NULL)))
WHERE key IN (SELECT work_key FROM point WHERE sweep_id = $1 AND verifies IN (false, true) AND ordinal > $2 AND ordinal <= $3) AND is_open

-- name: KEEP_RUNNING_WORK
-- Withdraws the requested cancellation of a sweep's leased work.
-- $1 sweep.
UPDATE work SET cancel_requested = false
WHERE state = 'leased' AND cancel_requested AND key IN (SELECT work_key FROM point WHERE sweep_id = $1)

-- name: LEAVE_WORK
-- Stores the `cancelled` events of a cancelled sweep for open work that continues for other sweeps.
-- $1 sweep, $2 ordinal before the first point, $3 ordinal of the last.
INSERT INTO event (sweep_id, seq, kind, work_key, at)
SELECT s.id, s.version + row_number() OVER (ORDER BY shared.key), 'cancelled', shared.key, (SELECT now FROM clock)
FROM (SELECT DISTINCT w.key FROM point p JOIN work w ON w.key = p.work_key
      WHERE p.sweep_id = $1 AND p.verifies IN (false, true) AND p.ordinal > $2 AND p.ordinal <= $3 AND w.is_open AND w.stage_of_cancelled = 'cancelled') AS shared
JOIN sweep s ON s.id = $1

-- name: LEFT_HIDDEN
-- Sweeps whose process has abandoned them while hidden.
-- $1 least time since their last renewal [ms].
SELECT id FROM sweep WHERE hidden IS NOT NULL AND hidden < (SELECT now FROM clock) - $1

-- name: OWN_RESULTS
-- Results of a sweep that no other sweep has.
-- $1 sweep.
-- Returns: number, size of their unexpired artifacts [bytes].
SELECT count(*),
       CAST(coalesce(sum((SELECT sum(bytes) FROM artifact WHERE work_key = own.work_key AND expired IS NULL)), 0) AS bigint)
FROM (SELECT DISTINCT p.work_key FROM point p
      WHERE p.sweep_id = $1
        AND NOT EXISTS (SELECT 1 FROM point o WHERE o.work_key = p.work_key AND o.sweep_id <> $1)) AS own
JOIN result ON result.work_key = own.work_key

-- name: PAUSE
-- Pauses or resumes a sweep.
-- $1 sweep, $2 true to pause it.
UPDATE sweep SET paused = $2, version = version + 1, revision = revision + 1 WHERE id = $1 AND hidden IS NULL

-- name: RECOUNT
-- Recounts all points and verification runs of a sweep whose cancellation was withdrawn.
-- $1 sweep.
UPDATE sweep SET (points_queued, points_running, points_done, points_failed, points_cancelled,
                  verifications_queued, verifications_running, verifications_done, verifications_failed,
                  verifications_cancelled, finished) = (
    SELECT count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'queued'),
           count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'running'),
           count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'done'),
           count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'failed'),
           count(*) FILTER (WHERE NOT p.verifies AND w.stage = 'cancelled'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'queued'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'running'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'done'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'failed'),
           count(*) FILTER (WHERE p.verifies AND w.stage = 'cancelled'),
           CASE WHEN count(*) FILTER (WHERE w.is_open) = 0 THEN finished END
    FROM point p JOIN work w ON w.key = p.work_key
    WHERE p.sweep_id = $1)
WHERE id = $1

-- name: REQUEST
-- Request of a sweep.
-- $1 sweep.
SELECT request FROM sweep WHERE id = $1 AND hidden IS NULL

-- name: REQUEST_BYTES
-- Length of a sweep's request [bytes].
-- $1 sweep.
SELECT CAST(octet_length(request) AS bigint) FROM sweep WHERE id = $1 AND hidden IS NULL

-- name: REVIVE
-- Withdraws the cancellation of a sweep.
-- $1 sweep.
-- Returns: owner.
UPDATE sweep SET cancelled = false, cancelled_to = NULL, version = version + 1, revision = revision + 1 WHERE id = $1 AND hidden IS NULL RETURNING owner

-- name: STOP_WORK
-- Requests the cancellation of leased work of a sweep that no live sweep needs, as `CANCEL_WORK` does for all of its open work.
-- $1 sweep.
UPDATE work SET cancel_requested = true
WHERE state = 'leased' AND NOT cancel_requested
  AND EXISTS (SELECT 1 FROM point WHERE work_key = work.key AND sweep_id = $1)
  AND NOT EXISTS (SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
                  WHERE p.work_key = work.key AND NOT s.cancelled
                    AND (s.refreshes
                         OR NOT EXISTS (SELECT 1 FROM result r WHERE r.work_key = work.key AND r.damaged IS NULL)))

-- name: VERSION
-- The version of a sweep.
-- $1 sweep.
SELECT version FROM sweep WHERE id = $1 AND hidden IS NULL
