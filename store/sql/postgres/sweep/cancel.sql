-- Marks a sweep as cancelled, unless it is so already. What it has open counts as cancelled; what is stopped for it counts as running
-- again until it has ended (`cancel_work`).
-- $1 sweep.
UPDATE sweep SET
    cancelled = true, cancelled_to = 0, version = version + 1, revision = revision + 1, finished = coalesce(finished, (SELECT now FROM clock)),
    points_cancelled = points_cancelled + points_queued + points_running, points_queued = 0, points_running = 0,
    verifications_cancelled = verifications_cancelled + verifications_queued + verifications_running,
    verifications_queued = 0, verifications_running = 0
WHERE id = $1 AND NOT cancelled
