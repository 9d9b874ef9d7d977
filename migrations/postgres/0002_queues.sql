-- The turnstile: a change of a work item's state that has consequences for others (the turn of its owner, the counts of its sweeps)
-- goes through it, one transaction at a time. Without it many workers would wait for the same rows: with every commit all of them
-- would wake up, find the row changed and wait again, and what the last saw when it began would keep old versions of the row
-- alive, through which each has to go. `LOCK TABLE` waits without such a snapshot, where it is a statement of its own
-- (store/src/database/postgres.rs). It comes after the writers' lock.
CREATE TABLE turnstile ();

-- Hands out the next work item: of the owner whose turn it is the most urgent, of these the first in the order asked for. What others
-- are changing is skipped, and an owner with nothing else. The owners are gone through in the order of their turns, as far as the first
-- that has something: the order is that of the inner query. A function, since its plan is kept.
CREATE FUNCTION claim_work(claiming_worker text, length_of_lease bigint, version_of_numbers bigint)
RETURNS TABLE (key bytea, fencing_token bigint, base text, changes text, checkpoint text) LANGUAGE plpgsql AS $$
#variable_conflict use_column
BEGIN
    RETURN QUERY
    WITH picked AS (
        SELECT ready.key
        FROM (SELECT owner FROM owner_turn ORDER BY vtime, owner) AS turn
        CROSS JOIN LATERAL (
            SELECT key FROM work
            WHERE state = 'queued' AND NOT held AND physics_version = version_of_numbers AND work.owner = turn.owner
            ORDER BY priority DESC, vtime, key LIMIT 1
            FOR NO KEY UPDATE SKIP LOCKED) AS ready
        LIMIT 1)
    UPDATE work SET
        state = 'leased', fencing_token = fencing_token + 1, attempts = attempts + 1, progress = 0,
        worker_note = NULL, lease_owner = claiming_worker, lease_until = (SELECT now FROM clock) + length_of_lease,
        lease_ms = length_of_lease, changed = (SELECT now FROM clock)
    FROM picked
    WHERE work.key = picked.key
    RETURNING work.key, work.fencing_token, (SELECT text FROM scenario WHERE hash = work.base), work.changes, work.checkpoint;
END
$$;

-- Ends a lease with a result, if that is the first of its work item. Gives what came of it: 'done'; 'lost', the lease; 'earlier' if there
-- is a result already; 'missing' and the name of a blob that is not reserved. Nothing is written but for the first.
CREATE FUNCTION finish_work(
    work_item bytea, token bigint, worker text, new_summary text, new_provenance text, new_artifacts json
) RETURNS text LANGUAGE plpgsql AS $$
DECLARE
    missing text;
    moment bigint;
BEGIN
    IF EXISTS (SELECT 1 FROM result WHERE work_key = work_item) THEN
        RETURN 'earlier';
    END IF;
    PERFORM 1 FROM work
    WHERE key = work_item AND fencing_token = token AND lease_owner = worker AND state = 'leased' FOR NO KEY UPDATE;
    IF NOT FOUND THEN
        RETURN 'lost';
    END IF;
    SELECT now FROM clock INTO moment;
    SELECT item ->> 'blob' FROM json_array_elements(new_artifacts) AS items (item)
    WHERE coalesce((SELECT expires FROM upload WHERE blob = item ->> 'blob'), 0) <= moment
    LIMIT 1 INTO missing;
    IF FOUND THEN
        RETURN 'missing ' || missing;
    END IF;
    INSERT INTO result (work_key, summary, provenance, created) VALUES (work_item, new_summary, new_provenance, moment);
    INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count)
    SELECT work_item, item ->> 'name', item ->> 'media_type', item ->> 'blob', (item ->> 'bytes')::bigint, (item ->> 'row_count')::bigint
    FROM json_array_elements(new_artifacts) AS items (item);
    UPDATE work SET
        state = 'done', progress = 1, error = NULL, checkpoint = NULL, lease_until = NULL, changed = moment
    WHERE key = work_item;
    RETURN 'done';
END
$$;

-- What 0001_schema.sql says of it holds. One statement: each costs as much as what it does.
CREATE OR REPLACE FUNCTION tell_the_sweeps() RETURNS trigger LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    -- For those who have not been there before.
    LOCK TABLE turnstile IN EXCLUSIVE MODE;

    WITH changed AS (
        UPDATE sweep SET
            points_queued           = points_queued + share.points * step.queued,
            points_running          = points_running + share.points * step.running,
            points_done             = points_done + share.points * step.done,
            points_failed           = points_failed + share.points * step.failed,
            points_cancelled        = points_cancelled + share.points * step.cancelled,
            verifications_queued    = verifications_queued + share.verifications * step.queued,
            verifications_running   = verifications_running + share.verifications * step.running,
            verifications_done      = verifications_done + share.verifications * step.done,
            verifications_failed    = verifications_failed + share.verifications * step.failed,
            verifications_cancelled = verifications_cancelled + share.verifications * step.cancelled,
            version                 = version + CASE
                WHEN points_queued + points_running + verifications_queued + verifications_running + more.opened > 0 THEN 1
                ELSE 2
            END,
            finished                = CASE
                WHEN points_queued + points_running + verifications_queued + verifications_running + more.opened > 0 THEN NULL
                ELSE coalesce(finished, NEW.changed)
            END
        FROM (SELECT sweep_id, count(*) FILTER (WHERE NOT verifies) AS points, count(*) FILTER (WHERE verifies) AS verifications
              FROM point WHERE work_key = NEW.key GROUP BY sweep_id) AS share,
             (SELECT of_cancelled,
                     (after = 'queued')::int - (before = 'queued')::int       AS queued,
                     (after = 'running')::int - (before = 'running')::int     AS running,
                     (after = 'done')::int - (before = 'done')::int           AS done,
                     (after = 'failed')::int - (before = 'failed')::int       AS failed,
                     (after = 'cancelled')::int - (before = 'cancelled')::int AS cancelled
              FROM (SELECT false AS of_cancelled, OLD.stage AS before, NEW.stage AS after
                    WHERE NEW.state <> OLD.state
                    UNION ALL
                    SELECT true, OLD.stage_of_cancelled, NEW.stage_of_cancelled
                    WHERE NEW.stage_of_cancelled <> OLD.stage_of_cancelled
                       OR (NEW.state <> OLD.state AND NOT NEW.is_open)) AS stages) AS step,
             LATERAL (SELECT (share.points + share.verifications) * (step.queued + step.running) AS opened) AS more
        WHERE sweep.id = share.sweep_id AND sweep.cancelled = step.of_cancelled
        RETURNING id, CASE WHEN finished IS NULL THEN version ELSE version - 1 END AS seq, sweep.cancelled)
    INSERT INTO event (sweep_id, seq, kind, work_key, at)
    SELECT id, seq, CASE WHEN cancelled AND NEW.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE NEW.state END,
           NEW.key, NEW.changed
    FROM changed;
    RETURN NULL;
END
$$;
