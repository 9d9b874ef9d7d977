-- A change of a work item's state has consequences for others: the turn of its owner, the counts, events and end of the sweeps that have it.
-- These rows are few, and all workers change them: if each did so in its own transaction, all would wait for each other. So a transaction
-- only notes what it changed, in a row of its own that is committed with the change, and these notes are applied in batches: by
-- whoever has committed one, as long as nobody else is applying some (store/src/database/postgres.rs). Alone, a
-- change is applied before its client hears that it is made; of many at once the first applies its own, and the next all that came
-- meanwhile. What a process that dies leaves behind, the next one applies.

-- Changes of work items that have not been applied yet.
CREATE TABLE transition (
    -- In the order of the changes of one work item, whose row is locked from its change to its commit.
    number                    BIGINT  NOT NULL GENERATED ALWAYS AS IDENTITY,
    -- The transaction that made it. What is applied is deleted, and its remains in the index are passed over by this column
    -- (`transitions_applied`).
    transaction               XID8    NOT NULL DEFAULT pg_current_xact_id(),
    work_key                  BYTEA   NOT NULL,
    owner                     TEXT COLLATE "C" NOT NULL,
    physics_version           BIGINT  NOT NULL,
    -- As in the table `work`, before the change and after it.
    state_before              TEXT COLLATE "C" NOT NULL,
    state                     TEXT COLLATE "C" NOT NULL,
    stage_before              TEXT COLLATE "C" NOT NULL,
    stage                     TEXT COLLATE "C" NOT NULL,
    stage_of_cancelled_before TEXT COLLATE "C" NOT NULL,
    stage_of_cancelled        TEXT COLLATE "C" NOT NULL,
    is_open                   BOOLEAN NOT NULL,
    at                        BIGINT  NOT NULL
) WITH (autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 20000, autovacuum_vacuum_cost_delay = 0);

CREATE INDEX transition_by_transaction ON transition (transaction);

-- One row: the first transaction of which there may be transitions that have not been applied.
CREATE TABLE transitions_applied (
    up_to XID8 NOT NULL
);

INSERT INTO transitions_applied (up_to) VALUES ('0');

-- The same, for a database that was restored from a dump as well: there transactions are counted anew.
CREATE VIEW first_to_apply AS
SELECT CASE WHEN up_to <= pg_snapshot_xmax(pg_current_snapshot()) THEN up_to ELSE '0' END AS transaction FROM transitions_applied;

-- Before which there is nothing in an owner's queue, so that a claim does not go through all that the index still has of work that was
-- claimed before. Raised with claims that are applied; given up where work may have come back before it. Without a row the whole
-- queue is looked through.
CREATE TABLE queue_start (
    owner           TEXT COLLATE "C" NOT NULL,
    physics_version BIGINT NOT NULL,
    -- The priority, negative.
    urgency         BIGINT NOT NULL,
    vtime           BIGINT NOT NULL,
    PRIMARY KEY (owner, physics_version)
) WITH (fillfactor = 50);

-- In the order of claims, all ascending: so a place in it is one bound.
DROP INDEX work_ready;
CREATE INDEX work_ready ON work (physics_version, owner, (-priority), vtime, key) WHERE state = 'queued' AND NOT held;

DROP TRIGGER work_takes_a_turn ON work;
DROP FUNCTION take_a_turn;
DROP TRIGGER work_changes_state ON work;
DROP FUNCTION tell_the_sweeps;
DROP TABLE turnstile;

-- All that follows at once from a change of a work item. One trigger without a condition: conditions are prepared anew for each statement,
-- which takes longer than all the rest of it.
DROP TRIGGER work_keeps_to_its_transitions ON work;
DROP FUNCTION refuse_transition;
DROP TRIGGER work_is_queued ON work;

CREATE FUNCTION work_has_changed() RETURNS trigger LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    -- Work goes its ways and no others, whichever statement moves it.
    IF NEW.state <> OLD.state AND NOT (CASE OLD.state
           WHEN 'queued'  THEN NEW.state IN ('leased', 'done', 'failed', 'cancelled')
           WHEN 'leased'  THEN NEW.state IN ('waiting', 'queued', 'done', 'failed', 'dead', 'cancelled')
           WHEN 'waiting' THEN NEW.state IN ('queued', 'done', 'failed', 'cancelled')
           ELSE NEW.state = 'queued'
       END) THEN
        RAISE EXCEPTION 'a work item cannot go from its state to that one';
    END IF;
    IF NEW.state <> OLD.state OR NEW.stage_of_cancelled <> OLD.stage_of_cancelled THEN
        INSERT INTO transition (work_key, owner, physics_version, state_before, state, stage_before, stage,
                                stage_of_cancelled_before, stage_of_cancelled, is_open, at)
        VALUES (NEW.key, NEW.owner, NEW.physics_version, OLD.state, NEW.state, OLD.stage, NEW.stage,
                OLD.stage_of_cancelled, NEW.stage_of_cancelled, NEW.is_open, NEW.changed);
    END IF;
    IF NEW.state = 'queued' AND NOT NEW.held AND (OLD.state <> 'queued' OR OLD.held) THEN
        NOTIFY drillsweep_work;
    END IF;
    RETURN NULL;
END
$$;

CREATE TRIGGER work_has_changed AFTER UPDATE OF state, held, cancel_requested ON work
FOR EACH ROW EXECUTE FUNCTION work_has_changed();

-- Applies all transitions that are committed, and those of its own transaction. Nobody changes turns and sweeps beside it: all who do so
-- hold the lock that it takes.
--
-- A change reaches every sweep that has the work item, in the order of the changes: counts, version, end, event. A sweep may have the
-- same work item at several points, and verify points by it; it is finished when neither its points nor its reference runs have an
-- open one. A cancelled sweep counts by `stage_of_cancelled`, and of what others compute it hears only the outcome. The version
-- of a finished sweep is one more than the number of its last event: who has seen that event, and not the end, is told from
-- who has seen both.
--
-- Owners pay for the turns that they have taken. Idle time is not saved up: who comes back has missed all turns but the one before the
-- latest.
--
-- Each row is looked up by an index, whatever the planner thinks of tables that have just grown.
CREATE FUNCTION apply_pending_transitions() RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT
SET plan_cache_mode = force_generic_plan SET enable_seqscan = off SET enable_hashjoin = off SET enable_mergejoin = off AS $$
DECLARE
    first_pending xid8;
    next_pending  xid8;
    is_alone      boolean := coalesce(current_setting('drillsweep.alone', true) = 'on', false);
BEGIN
    PERFORM pg_advisory_xact_lock(7237963465534699366);
    IF is_alone THEN
        -- Who is alone may put work anywhere.
        DELETE FROM queue_start;
    END IF;
    -- All transactions before `next_pending` have ended, and are seen by the statement that follows.
    SELECT transaction, pg_snapshot_xmin(pg_current_snapshot()) INTO first_pending, next_pending FROM first_to_apply;

    WITH pending AS MATERIALIZED (
        DELETE FROM transition WHERE transaction >= first_pending RETURNING *),
    turn AS (
        UPDATE owner_turn SET vtime = greatest(vtime, (SELECT max(vtime) FROM owner_turn) - 1000) + 1000 * taken.turns
        FROM (SELECT owner, count(*) AS turns FROM pending
              WHERE state = 'leased' AND state_before <> 'leased' GROUP BY owner) AS taken
        WHERE owner_turn.owner = taken.owner),
    restart AS (
        DELETE FROM queue_start WHERE owner IN (SELECT owner FROM pending WHERE state = 'queued')),
    start AS (
        INSERT INTO queue_start AS earlier (owner, physics_version, urgency, vtime)
        SELECT taken.owner, taken.physics_version, ready.urgency, ready.vtime
        FROM (SELECT DISTINCT owner, physics_version FROM pending
              WHERE state = 'leased' AND NOT is_alone AND owner NOT IN (SELECT owner FROM pending WHERE state = 'queued')) AS taken
        LEFT JOIN queue_start AS known ON known.owner = taken.owner AND known.physics_version = taken.physics_version
        CROSS JOIN LATERAL (
            SELECT -priority AS urgency, vtime FROM work
            WHERE state = 'queued' AND NOT held AND physics_version = taken.physics_version AND owner = taken.owner
              AND (-priority, vtime) >= (coalesce(known.urgency, -9223372036854775808), coalesce(known.vtime, -9223372036854775808))
            ORDER BY -priority, vtime LIMIT 1) AS ready
        ON CONFLICT (owner, physics_version) DO UPDATE SET urgency = excluded.urgency, vtime = excluded.vtime
        WHERE (earlier.urgency, earlier.vtime) <> (excluded.urgency, excluded.vtime)),
    heard AS (
        SELECT sweep.id, sweep.version, sweep.finished, pending.number, pending.work_key, pending.at,
               CASE WHEN sweep.cancelled AND pending.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE pending.state END AS kind,
               share.points, share.verifications, step.before, step.after,
               points_queued + points_running + verifications_queued + verifications_running AS open_before,
               (share.points + share.verifications)
                   * ((step.after IN ('queued', 'running'))::int - (step.before IN ('queued', 'running'))::int) AS opened
        FROM pending
        CROSS JOIN LATERAL (
            SELECT sweep_id, count(*) FILTER (WHERE NOT verifies) AS points, count(*) FILTER (WHERE verifies) AS verifications
            FROM point WHERE point.work_key = pending.work_key GROUP BY sweep_id) AS share
        JOIN sweep ON sweep.id = share.sweep_id
        CROSS JOIN LATERAL (
            SELECT CASE WHEN sweep.cancelled THEN pending.stage_of_cancelled_before ELSE pending.stage_before END AS before,
                   CASE WHEN sweep.cancelled THEN pending.stage_of_cancelled ELSE pending.stage END AS after) AS step
        WHERE CASE WHEN sweep.cancelled
                   THEN step.after <> step.before OR (pending.state <> pending.state_before AND NOT pending.is_open)
                   ELSE pending.state <> pending.state_before
              END),
    counted AS (
        SELECT *, open_before + sum(opened) OVER (PARTITION BY id ORDER BY number) AS open_after FROM heard),
    numbered AS (
        SELECT *, version + sum(CASE open_after WHEN 0 THEN 2 ELSE 1 END) OVER (PARTITION BY id ORDER BY number) AS version_after,
               open_after = 0 AND lag(open_after, 1, open_before::numeric) OVER (PARTITION BY id ORDER BY number) > 0 AS is_end
        FROM counted),
    told AS (
        INSERT INTO event (sweep_id, seq, kind, work_key, at)
        SELECT id, CASE open_after WHEN 0 THEN version_after - 1 ELSE version_after END, kind, work_key, at FROM numbered)
    UPDATE sweep SET
        version                 = step.version,
        points_queued           = sweep.points_queued + step.points_queued,
        points_running          = sweep.points_running + step.points_running,
        points_done             = sweep.points_done + step.points_done,
        points_failed           = sweep.points_failed + step.points_failed,
        points_cancelled        = sweep.points_cancelled + step.points_cancelled,
        verifications_queued    = sweep.verifications_queued + step.verifications_queued,
        verifications_running   = sweep.verifications_running + step.verifications_running,
        verifications_done      = sweep.verifications_done + step.verifications_done,
        verifications_failed    = sweep.verifications_failed + step.verifications_failed,
        verifications_cancelled = sweep.verifications_cancelled + step.verifications_cancelled,
        finished                = CASE WHEN step.open_after > 0 THEN NULL ELSE coalesce(step.ended, finished, step.last) END
    FROM (SELECT id, max(version_after) AS version, max(open_before) + sum(opened) AS open_after,
                 max(at) FILTER (WHERE is_end) AS ended, max(at) AS last,
                 sum(points * ((after = 'queued')::int - (before = 'queued')::int)) AS points_queued,
                 sum(points * ((after = 'running')::int - (before = 'running')::int)) AS points_running,
                 sum(points * ((after = 'done')::int - (before = 'done')::int)) AS points_done,
                 sum(points * ((after = 'failed')::int - (before = 'failed')::int)) AS points_failed,
                 sum(points * ((after = 'cancelled')::int - (before = 'cancelled')::int)) AS points_cancelled,
                 sum(verifications * ((after = 'queued')::int - (before = 'queued')::int)) AS verifications_queued,
                 sum(verifications * ((after = 'running')::int - (before = 'running')::int)) AS verifications_running,
                 sum(verifications * ((after = 'done')::int - (before = 'done')::int)) AS verifications_done,
                 sum(verifications * ((after = 'failed')::int - (before = 'failed')::int)) AS verifications_failed,
                 sum(verifications * ((after = 'cancelled')::int - (before = 'cancelled')::int)) AS verifications_cancelled
          FROM numbered GROUP BY id) AS step
    WHERE sweep.id = step.id;

    UPDATE transitions_applied SET up_to = next_pending WHERE up_to <> next_pending;
END
$$;

-- Applies what is pending, unless somebody else does so at this moment. Gives whether it has done so: then something may have come
-- meanwhile that is left to it, and this is to be called again once it is committed. Nobody waits for the disk: what is applied and then
-- forgotten by a crash is pending again.
CREATE FUNCTION apply_transitions() RETURNS boolean LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    IF NOT EXISTS (SELECT 1 FROM transition WHERE transaction >= (SELECT transaction FROM first_to_apply))
       OR NOT pg_try_advisory_xact_lock(7237963465534699366) THEN
        RETURN false;
    END IF;
    -- A batch costs much the same whether it is one change or twenty: where many are at work, what they commit within a moment goes with it.
    IF EXISTS (SELECT 1 FROM transition WHERE transaction >= (SELECT transaction FROM first_to_apply) OFFSET 3) THEN
        PERFORM pg_sleep(0.005);
    END IF;
    PERFORM set_config('synchronous_commit', 'off', true);
    PERFORM apply_pending_transitions();
    RETURN true;
END
$$;

-- Begins a transaction that has work, points and sweeps to itself. All changes before it are applied, and its own with each of its
-- statements.
CREATE FUNCTION write_alone() RETURNS void LANGUAGE plpgsql AS $$
BEGIN
    PERFORM pg_advisory_xact_lock(7237963465534699365);
    PERFORM set_config('drillsweep.alone', 'on', true);
    PERFORM apply_pending_transitions();
END
$$;

CREATE FUNCTION apply_own_transitions() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF current_setting('drillsweep.alone', true) = 'on' THEN
        PERFORM apply_pending_transitions();
    END IF;
    RETURN NULL;
END
$$;

CREATE TRIGGER work_is_written_alone AFTER UPDATE OF state, cancel_requested ON work FOR EACH STATEMENT EXECUTE FUNCTION apply_own_transitions();

-- As in 0002_queues.sql. It takes the writers' lock itself, before it looks, and begins where the queues do; where nothing is found, at their
-- very beginning.
CREATE OR REPLACE FUNCTION claim_work(claiming_worker text, length_of_lease bigint, version_of_numbers bigint)
RETURNS TABLE (key bytea, fencing_token bigint, base text, changes text, checkpoint text) LANGUAGE plpgsql AS $$
#variable_conflict use_column
DECLARE
    all_of_it boolean;
BEGIN
    PERFORM pg_advisory_xact_lock_shared(7237963465534699365);
    FOREACH all_of_it IN ARRAY ARRAY[false, true] LOOP
        RETURN QUERY
        WITH picked AS (
            SELECT ready.key, now
            FROM (SELECT owner_turn.owner, coalesce(urgency, -9223372036854775808) AS urgency,
                         coalesce(queue_start.vtime, -9223372036854775808) AS vtime
                  FROM owner_turn
                  LEFT JOIN queue_start ON queue_start.owner = owner_turn.owner AND physics_version = version_of_numbers AND NOT all_of_it
                  ORDER BY owner_turn.vtime, owner_turn.owner) AS turn
            CROSS JOIN LATERAL (
                SELECT key FROM work
                WHERE state = 'queued' AND NOT held AND physics_version = version_of_numbers AND work.owner = turn.owner
                  AND (-priority, work.vtime) >= (turn.urgency, turn.vtime)
                ORDER BY -priority, work.vtime, key LIMIT 1
                FOR NO KEY UPDATE SKIP LOCKED) AS ready
            CROSS JOIN clock
            LIMIT 1)
        UPDATE work SET
            state = 'leased', fencing_token = fencing_token + 1, attempts = attempts + 1, progress = 0,
            worker_note = NULL, lease_owner = claiming_worker, lease_until = now + length_of_lease,
            lease_ms = length_of_lease, changed = now
        FROM picked
        WHERE work.key = picked.key
        RETURNING work.key, work.fencing_token, (SELECT text FROM scenario WHERE hash = work.base), work.changes, work.checkpoint;
        IF FOUND THEN
            RETURN;
        END IF;
    END LOOP;
END
$$;

-- As in 0002_queues.sql.
CREATE OR REPLACE FUNCTION finish_work(
    work_item bytea, token bigint, worker text, new_summary text, new_provenance text, new_artifacts json
) RETURNS text LANGUAGE plpgsql AS $$
DECLARE
    missing text;
    moment bigint;
BEGIN
    PERFORM pg_advisory_xact_lock_shared(7237963465534699365);
    IF EXISTS (SELECT 1 FROM result WHERE work_key = work_item) THEN
        RETURN 'earlier';
    END IF;
    SELECT now FROM clock INTO moment;
    SELECT blob FROM json_to_recordset(new_artifacts) AS item (blob text)
    WHERE NOT EXISTS (SELECT 1 FROM upload WHERE upload.blob = item.blob AND expires > moment)
    LIMIT 1 INTO missing;
    IF FOUND AND EXISTS (SELECT 1 FROM work WHERE key = work_item AND fencing_token = token AND lease_owner = worker AND state = 'leased') THEN
        RETURN 'missing ' || missing;
    END IF;
    UPDATE work SET
        state = 'done', progress = 1, error = NULL, checkpoint = NULL, lease_until = NULL, changed = moment
    WHERE key = work_item AND fencing_token = token AND lease_owner = worker AND state = 'leased';
    IF NOT FOUND THEN
        RETURN 'lost';
    END IF;
    INSERT INTO result (work_key, summary, provenance, created) VALUES (work_item, new_summary, new_provenance, moment);
    INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count)
    SELECT work_item, name, media_type, blob, bytes, row_count
    FROM json_to_recordset(new_artifacts) AS item (name text, media_type text, blob text, bytes bigint, row_count bigint);
    RETURN 'done';
END
$$;

-- Reserves a blob for a row to come, unless it is being deleted: it is not deleted until then. Who has reserved it for longer keeps it. Gives
-- the blob; nothing if it is being deleted.
CREATE FUNCTION reserve_blob(name text, length_of_reservation bigint) RETURNS SETOF text LANGUAGE plpgsql AS $$
BEGIN
    PERFORM pg_advisory_xact_lock_shared(7237963465534699365);
    RETURN QUERY
    INSERT INTO upload (blob, expires)
    SELECT name, now + length_of_reservation FROM clock
    WHERE NOT EXISTS (SELECT 1 FROM removal WHERE removal.blob = name AND expires > now)
    ON CONFLICT (blob) DO UPDATE SET expires = greatest(upload.expires, excluded.expires)
    RETURNING blob;
END
$$;

-- A renewal changes no column that an index has, and finds room beside its row: so it writes no index.
ALTER TABLE work SET (fillfactor = 80);
DROP INDEX work_leased;
CREATE INDEX work_leased ON work (key) WHERE state = 'leased';
