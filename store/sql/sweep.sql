-- name: CANCEL
-- Marks a sweep as cancelled, unless it is so already. What it has open counts as cancelled; what is stopped for it counts as running
-- again until it has ended (`CANCEL_WORK`).
-- $1 sweep.
UPDATE sweep SET
    cancelled = true, cancelled_to = 0, version = version + 1, revision = revision + 1, finished = coalesce(finished, (SELECT now FROM clock)),
    points_cancelled = points_cancelled + points_queued + points_running, points_queued = 0, points_running = 0,
    verifications_cancelled = verifications_cancelled + verifications_queued + verifications_running,
    verifications_queued = 0, verifications_running = 0
WHERE id = $1 AND NOT cancelled

-- name: CANCEL_TO
-- Notes up to which point the work of a cancelled sweep is cancelled.
-- $1 sweep, $2 the ordinal.
UPDATE sweep SET cancelled_to = CASE WHEN $2 < points THEN CAST($2 AS bigint) END WHERE id = $1

-- name: CANCEL_WORK
-- Cancels the open work of a sweep that no live sweep wants: has a point of it, or verifies one by it, and of work that has
-- a result which is not damaged, asks to recompute it. What is under way ends when its worker hears of it. A result from before stays, and
-- the work is done then.
-- $1 sweep, $2 ordinal after which its points are, $3 the last.
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
-- Up to which point the work of a cancelled sweep is cancelled.
-- $1 sweep.
-- Gives: the ordinal, number of points; nothing once all of it is.
SELECT cancelled_to, points FROM sweep WHERE id = $1 AND cancelled_to IS NOT NULL

-- name: CHANGE
-- Changes what can be changed of a sweep.
-- $1 sweep, $2 whether the name changes, $3 name, $4 priority or none, $5 tags or none, $6 whether it is pinned, or none,
-- $7 whether the time changes at which it is deleted, $8 that time, $9 the revision that it must have, or none for any.
UPDATE sweep SET
    name = CASE WHEN $2 THEN $3 ELSE name END, priority = coalesce($4, priority),
    tags = coalesce($5, tags), pinned = coalesce($6, pinned),
    expires = CASE WHEN $7 THEN $8 ELSE expires END, version = version + 1, revision = revision + 1
WHERE id = $1 AND hidden IS NULL AND ($9 IS NULL OR revision = $9)

-- name: CHANGE_PRIORITY_OF_WORK
-- Gives the open work of a sweep the priority of the most urgent live sweep that has it.
-- $1 sweep.
UPDATE work SET
    priority = coalesce((SELECT max(s.priority) FROM point p JOIN sweep s ON s.id = p.sweep_id
                         WHERE p.work_key = work.key AND NOT s.cancelled), priority)
WHERE key IN (SELECT work_key FROM point WHERE sweep_id = $1) AND is_open

-- name: COUNT_EVENTS
-- Raises the version of a sweep beyond events that were stored at once.
-- $1 sweep, $2 their number; one more is added where it is finished.
UPDATE sweep SET version = version + $2 + CASE WHEN finished IS NULL THEN 0 ELSE 1 END WHERE id = $1

-- name: DELETABLE
-- Whether a sweep may be deleted, and what goes with it.
-- $1 sweep.
-- Gives: revision, whether it is pinned, when it finished, number of points.
SELECT revision, pinned, finished, points FROM sweep WHERE id = $1 AND hidden IS NULL

-- name: DELETE
-- Deletes a sweep; its points, events, requests and idempotency keys go with it.
-- $1 sweep.
DELETE FROM sweep WHERE id = $1

-- name: DELETE_EVENTS
-- Deletes the first events of a sweep that there are.
-- $1 sweep, $2 how many at most.
DELETE FROM event
WHERE sweep_id = $1 AND seq IN (SELECT seq FROM event WHERE sweep_id = $1 ORDER BY seq LIMIT $2)

-- name: DELETE_POINTS
-- Deletes the first points of a sweep that there are.
-- $1 sweep, $2 up to which ordinal.
DELETE FROM point WHERE sweep_id = $1 AND verifies IN (false, true) AND ordinal <= $2

-- name: FORGET_KEYS
-- Forgets for which idempotency keys a sweep was made.
-- $1 sweep.
DELETE FROM idempotency WHERE sweep_id = $1

-- name: HALF_CANCELLED
-- The sweeps whose work is not all cancelled yet.
SELECT id FROM sweep WHERE cancelled_to IS NOT NULL

-- name: HIDE
-- Hides a sweep, or keeps it hidden.
-- $1 sweep.
UPDATE sweep SET hidden = (SELECT now FROM clock) WHERE id = $1

-- name: HOLD_BACK
-- Holds back the open work of a sweep, or lets it go: it is held while no live sweep wants it that is not paused. A sweep
-- wants what it has a point of, or verifies one by, and of work that has a result which is not damaged, what it asks
-- to recompute.
-- $1 sweep, $2 ordinal after which its points are, $3 the last.
UPDATE work SET held = NOT EXISTS (
    SELECT 1 FROM point p JOIN sweep s ON s.id = p.sweep_id
    WHERE p.work_key = work.key AND NOT s.cancelled AND NOT s.paused
      AND (s.refreshes OR NOT EXISTS (SELECT 1 FROM result r WHERE r.work_key = work.key AND r.damaged IS NULL)))
WHERE key IN (SELECT work_key FROM point WHERE sweep_id = $1 AND verifies IN (false, true) AND ordinal > $2 AND ordinal <= $3) AND is_open

-- name: KEEP_RUNNING_WORK
-- Takes the cancellation of a sweep's work back that is under way.
-- $1 sweep.
UPDATE work SET cancel_requested = false
WHERE state = 'leased' AND cancel_requested AND key IN (SELECT work_key FROM point WHERE sweep_id = $1)

-- name: LEAVE_WORK
-- Tells those who watch a cancelled sweep that it is done with what goes on for others.
-- $1 sweep, $2 ordinal after which its points are, $3 the last.
INSERT INTO event (sweep_id, seq, kind, work_key, at)
SELECT s.id, s.version + row_number() OVER (ORDER BY shared.key), 'cancelled', shared.key, (SELECT now FROM clock)
FROM (SELECT DISTINCT w.key FROM point p JOIN work w ON w.key = p.work_key
      WHERE p.sweep_id = $1 AND p.verifies IN (false, true) AND p.ordinal > $2 AND p.ordinal <= $3 AND w.is_open AND w.stage_of_cancelled = 'cancelled') AS shared
JOIN sweep s ON s.id = $1

-- name: LEFT_HIDDEN
-- The sweeps that have been hidden for so long that nobody works on them any more.
-- $1 how long [ms].
SELECT id FROM sweep WHERE hidden IS NOT NULL AND hidden < (SELECT now FROM clock) - $1

-- name: OWN_RESULTS
-- The results of a sweep that no other one has.
-- $1 sweep.
-- Gives: their number, size of their tables [bytes].
SELECT count(*),
       CAST(coalesce(sum((SELECT sum(bytes) FROM artifact WHERE work_key = own.work_key AND expired IS NULL)), 0) AS bigint)
FROM (SELECT DISTINCT p.work_key FROM point p
      WHERE p.sweep_id = $1
        AND NOT EXISTS (SELECT 1 FROM point o WHERE o.work_key = p.work_key AND o.sweep_id <> $1)) AS own
JOIN result ON result.work_key = own.work_key

-- name: PAUSE
-- Marks a sweep as paused, or not any more.
-- $1 sweep, $2 whether it is paused.
UPDATE sweep SET paused = $2, version = version + 1, revision = revision + 1 WHERE id = $1 AND hidden IS NULL

-- name: RECOUNT
-- Counts all points of a sweep that is not cancelled any more, and the runs that verify them.
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

-- name: REVIVE
-- Takes a sweep's cancellation back.
-- $1 sweep.
-- Gives: owner.
UPDATE sweep SET cancelled = false, cancelled_to = NULL, version = version + 1, revision = revision + 1 WHERE id = $1 AND hidden IS NULL RETURNING owner

-- name: STOP_WORK
-- Asks for the end of what is under way for a sweep and no live sweep wants, as `CANCEL_WORK` does for all of its work.
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
