-- What was asked (sweep, point), what must be computed (work, by content hash), what came of it (result, artifact).
-- Times are integer milliseconds since the epoch, from the database's clock.
--
-- The same as the SQLite schema, table by table and column by column. Texts that are compared or sorted have the collation "C", by
-- which the order is the same on every server: that of their bytes.

-- What was asked: sweeps and their points.

CREATE TABLE sweep (
    -- A UUID of version 7: sorted by it, sweeps are in the order of their submission.
    id                      TEXT COLLATE "C" NOT NULL PRIMARY KEY,
    name                    TEXT COLLATE "C",
    owner                   TEXT COLLATE "C" NOT NULL,
    -- As it was submitted, JSON.
    request                 TEXT    NOT NULL,
    -- Higher goes first.
    priority                BIGINT  NOT NULL,
    -- A JSON array of texts.
    tags                    TEXT    NOT NULL DEFAULT '[]',
    cancelled               BOOLEAN NOT NULL DEFAULT false,
    -- The ordinal up to which the work of a cancelled sweep is cancelled; none once all of it is.
    cancelled_to            BIGINT,
    -- Since when nobody sees it: while its points are being stored, or taken away. What stays so for long was left behind by a
    -- process that died, and is taken away.
    hidden                  BIGINT,
    -- Its points are not handed out, but for those that another live sweep wants.
    paused                  BOOLEAN NOT NULL DEFAULT false,
    -- All that belongs to it is kept.
    pinned                  BOOLEAN NOT NULL DEFAULT false,
    -- It wants its points computed though they have results.
    refreshes               BOOLEAN NOT NULL DEFAULT false,
    -- Raised with every change of one of its points; the number of its last event.
    version                 BIGINT  NOT NULL DEFAULT 1,
    -- Raised with every change that somebody asked for.
    revision                BIGINT  NOT NULL DEFAULT 1,
    -- Points by the state of their work, kept by `apply_pending_transitions`: counting them at every look would cost
    -- more than computing them at some size of sweep.
    points                  BIGINT  NOT NULL,
    points_queued           BIGINT  NOT NULL DEFAULT 0,
    points_running          BIGINT  NOT NULL DEFAULT 0,
    points_done             BIGINT  NOT NULL DEFAULT 0,
    points_failed           BIGINT  NOT NULL DEFAULT 0,
    points_cancelled        BIGINT  NOT NULL DEFAULT 0,
    -- Reference runs by the state of their work, kept alike.
    verifications           BIGINT  NOT NULL DEFAULT 0,
    verifications_queued    BIGINT  NOT NULL DEFAULT 0,
    verifications_running   BIGINT  NOT NULL DEFAULT 0,
    verifications_done      BIGINT  NOT NULL DEFAULT 0,
    verifications_failed    BIGINT  NOT NULL DEFAULT 0,
    verifications_cancelled BIGINT  NOT NULL DEFAULT 0,
    created                 BIGINT  NOT NULL,
    -- When the last of its points and reference runs became final; none while one is not.
    finished                BIGINT,
    -- When it is to be deleted, once it is finished and unless it is pinned.
    expires                 BIGINT
) WITH (fillfactor = 50, autovacuum_vacuum_scale_factor = 0.02);

CREATE INDEX sweep_by_owner ON sweep (owner, id);
-- What was begun and is to be brought to its end.
CREATE INDEX sweep_half_cancelled ON sweep (id) WHERE cancelled_to IS NOT NULL;
CREATE INDEX sweep_hidden ON sweep (hidden) WHERE hidden IS NOT NULL;

-- The requests by which points were added to a sweep, a row each: in the row of the sweep, which is written with every change
-- of one of its points, they would make each of these writes as long as all of them.
CREATE TABLE appended (
    sweep_id TEXT COLLATE "C" NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    -- From 1, in the order in which they came.
    number   BIGINT  NOT NULL,
    request  TEXT    NOT NULL,
    PRIMARY KEY (sweep_id, number)
);

-- What a client's idempotency key was used for, so that a request that is sent twice is stored once.
CREATE TABLE idempotency (
    owner     TEXT COLLATE "C" NOT NULL,
    key       TEXT COLLATE "C" NOT NULL,
    -- Of the request: under the same key another one is refused.
    body_hash BYTEA   NOT NULL,
    sweep_id  TEXT COLLATE "C" NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    created   BIGINT  NOT NULL,
    PRIMARY KEY (owner, key)
);

CREATE INDEX idempotency_by_sweep ON idempotency (sweep_id);

-- What must be computed: the queue.

-- The texts that work items change: a hundred thousand points of one sweep share one instead of repeating it.
CREATE TABLE scenario (
    -- BLAKE3 of the text.
    hash BYTEA NOT NULL PRIMARY KEY,
    text TEXT NOT NULL
);

CREATE TABLE work (
    -- Content hash: equal keys, equal results.
    key              BYTEA   NOT NULL PRIMARY KEY,
    -- Version of the numbers that the key was made for; a worker takes only work of its own.
    physics_version  BIGINT  NOT NULL,
    -- In whose turn it is handed out.
    owner            TEXT COLLATE "C" NOT NULL,
    -- Which states there are, and which ways from one to another, is told by `TRANSITIONS` in store/src/work/state.rs.
    state            TEXT COLLATE "C" NOT NULL,
    -- How the sweeps that have it count it. This column and the next two follow from the state (`follow_state`).
    stage            TEXT COLLATE "C" NOT NULL DEFAULT 'queued',
    -- Still to be computed, or under way. All else is final, and changes only if somebody asks for it.
    is_open          BOOLEAN NOT NULL DEFAULT true,
    -- How cancelled sweeps that have it count it: what goes on for others is cancelled for them, what is being stopped has still to
    -- end.
    stage_of_cancelled TEXT COLLATE "C" NOT NULL DEFAULT 'cancelled',
    -- Wanted by paused sweeps only: not handed out until one of them goes on.
    held             BOOLEAN NOT NULL DEFAULT false,
    -- Within its owner the most urgent goes first, then the least place in the order asked for.
    priority         BIGINT  NOT NULL,
    vtime            BIGINT  NOT NULL,
    -- When a retry is due.
    ready_at         BIGINT  NOT NULL,
    -- Grows with every claim, and never falls: a write under an older one changes nothing.
    fencing_token    BIGINT  NOT NULL DEFAULT 0,
    -- How often a worker has started it and not given it back.
    attempts         BIGINT  NOT NULL DEFAULT 0,
    -- Deaths of workers, and failures of disk, object store or database, after which it is given up.
    crash_count      BIGINT  NOT NULL DEFAULT 0,
    failure_count    BIGINT  NOT NULL DEFAULT 0,
    lease_owner      TEXT COLLATE "C",
    lease_until      BIGINT,
    -- How long the lease is that its worker was given or has renewed: one that ends later than that from now was given before
    -- the clock was set back.
    lease_ms         BIGINT  NOT NULL DEFAULT 3600000,
    -- No sweep wants it any more; its worker learns it with the next renewal.
    cancel_requested BOOLEAN NOT NULL DEFAULT false,
    -- Simulated time over duration, 0 to 1.
    progress         DOUBLE PRECISION NOT NULL DEFAULT 0,
    -- Why it failed, JSON.
    error            TEXT,
    created          BIGINT  NOT NULL,
    -- When the state last changed. Every statement that changes the state sets it.
    changed          BIGINT  NOT NULL,
    -- The blob that a suspended run goes on from; none for one that begins at its start.
    checkpoint       TEXT COLLATE "C",
    base             BYTEA,
    -- What the work item has in place of the base's values: a JSON object by path.
    changes          TEXT    NOT NULL DEFAULT '{}',
    -- What is known of the worker that has the work, should it be heard of no more: how full its memory was, or how its process ended.
    worker_note      TEXT
) WITH (
    autovacuum_vacuum_scale_factor = 0.02, autovacuum_analyze_scale_factor = 0.02,
    -- A renewal changes no column that an index has, and finds room next to its row: so it writes no index.
    fillfactor = 80
);

-- Only the rows that a statement looks for: these indexes stay small however many points are finished. They are few, since each claim,
-- each result and each submitted point writes them. All open work is gone through by `work_open_by_owner`; work that waits for a version
-- of the numbers is in `work_ready`, in `work_waiting`, or held.

-- In the order of claims, all ascending: so a place in it is one bound.
CREATE INDEX work_ready ON work (physics_version, owner, (-priority), vtime, key) WHERE state = 'queued' AND NOT held;
CREATE INDEX work_held ON work (physics_version) WHERE state = 'queued' AND held;
CREATE INDEX work_leased ON work (key) WHERE state = 'leased';
CREATE INDEX work_waiting ON work (ready_at) WHERE state = 'waiting';
CREATE INDEX work_open_by_owner ON work (owner, vtime) WHERE is_open;
-- What was given up, the latest first.
CREATE INDEX work_given_up ON work (changed) WHERE stage = 'failed';

-- Points, and next to them the reference runs that verify some: cancelling, pausing, retrying, priority and retention go by the
-- work behind a row, and hold for both. Counts and listings tell them apart by `verifies`.
CREATE TABLE point (
    sweep_id   TEXT COLLATE "C" NOT NULL,
    -- Whether it is the reference run that verifies the point with this ordinal, and not that point.
    verifies   BOOLEAN NOT NULL,
    -- From 1.
    ordinal    BIGINT  NOT NULL,
    -- The swept parameters, a JSON object.
    parameters TEXT    NOT NULL,
    -- A sweep may have the same work at several points, and several sweeps may.
    work_key   BYTEA   NOT NULL,
    PRIMARY KEY (sweep_id, verifies, ordinal)
);

CREATE INDEX point_by_work ON point (work_key);

-- Owners take turns (start-time fair queueing): the one whose virtual time is least is served, and pays for it. Within an
-- owner the most urgent goes first, then the order asked for: work.vtime is a place in that order.
CREATE TABLE owner_turn (
    owner TEXT COLLATE "C" NOT NULL PRIMARY KEY,
    vtime BIGINT NOT NULL
) WITH (fillfactor = 50);

-- Changes of state, for those who watch a sweep.
CREATE TABLE event (
    sweep_id TEXT COLLATE "C" NOT NULL,
    -- The sweep's version after the change.
    seq      BIGINT NOT NULL,
    -- The new state of the work.
    kind     TEXT COLLATE "C" NOT NULL,
    work_key BYTEA  NOT NULL,
    at       BIGINT NOT NULL,
    PRIMARY KEY (sweep_id, seq)
);

-- References of points, bases and events, checked once a statement instead of once a row. Points, bases and sweeps are stored and deleted by
-- those who have them to themselves, so that no row has to be locked for it; and events are told to sweeps that exist.

CREATE FUNCTION require_base() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF EXISTS (SELECT 1 FROM (SELECT DISTINCT base FROM fresh WHERE base IS NOT NULL) AS used
               WHERE NOT EXISTS (SELECT 1 FROM scenario WHERE hash = base)) THEN
        RAISE EXCEPTION 'a work item changes a base that is not there' USING ERRCODE = 'foreign_key_violation';
    END IF;
    RETURN NULL;
END
$$;

CREATE TRIGGER work_has_its_base AFTER INSERT ON work REFERENCING NEW TABLE AS fresh
FOR EACH STATEMENT EXECUTE FUNCTION require_base();

CREATE FUNCTION keep_used_bases() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF EXISTS (SELECT 1 FROM gone JOIN work ON base = hash) THEN
        RAISE EXCEPTION 'a base is deleted that a work item changes' USING ERRCODE = 'foreign_key_violation';
    END IF;
    RETURN NULL;
END
$$;

CREATE TRIGGER scenario_is_not_used AFTER DELETE ON scenario REFERENCING OLD TABLE AS gone
FOR EACH STATEMENT EXECUTE FUNCTION keep_used_bases();

-- Each row is looked up by an index, whatever the planner thinks of tables that have just grown. So in the functions that follow.
CREATE FUNCTION require_sweep_and_work() RETURNS trigger LANGUAGE plpgsql
SET plan_cache_mode = force_generic_plan SET enable_seqscan = off SET enable_hashjoin = off SET enable_mergejoin = off AS $$
BEGIN
    IF EXISTS (SELECT 1 FROM fresh WHERE NOT EXISTS (SELECT 1 FROM work WHERE key = work_key))
       OR EXISTS (SELECT 1 FROM (SELECT DISTINCT sweep_id FROM fresh) AS used
                  WHERE NOT EXISTS (SELECT 1 FROM sweep WHERE id = sweep_id)) THEN
        RAISE EXCEPTION 'a point has a sweep or a work item that is not there' USING ERRCODE = 'foreign_key_violation';
    END IF;
    RETURN NULL;
END
$$;

CREATE TRIGGER point_has_its_sweep_and_work AFTER INSERT ON point REFERENCING NEW TABLE AS fresh
FOR EACH STATEMENT EXECUTE FUNCTION require_sweep_and_work();

CREATE FUNCTION keep_used_work() RETURNS trigger LANGUAGE plpgsql
SET plan_cache_mode = force_generic_plan SET enable_seqscan = off SET enable_hashjoin = off SET enable_mergejoin = off AS $$
BEGIN
    IF EXISTS (SELECT 1 FROM gone JOIN point ON work_key = key) THEN
        RAISE EXCEPTION 'a work item is deleted that a point has' USING ERRCODE = 'foreign_key_violation';
    END IF;
    RETURN NULL;
END
$$;

CREATE TRIGGER work_is_no_points AFTER DELETE ON work REFERENCING OLD TABLE AS gone
FOR EACH STATEMENT EXECUTE FUNCTION keep_used_work();

CREATE FUNCTION take_points_and_events_away() RETURNS trigger LANGUAGE plpgsql
SET plan_cache_mode = force_generic_plan SET enable_seqscan = off SET enable_hashjoin = off SET enable_mergejoin = off AS $$
BEGIN
    DELETE FROM point USING gone WHERE sweep_id = id;
    DELETE FROM event USING gone WHERE sweep_id = id;
    RETURN NULL;
END
$$;

CREATE TRIGGER sweep_goes_with_its_points AFTER DELETE ON sweep REFERENCING OLD TABLE AS gone
FOR EACH STATEMENT EXECUTE FUNCTION take_points_and_events_away();

-- What a row names stays what it is.
CREATE FUNCTION refuse_change() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    RAISE EXCEPTION 'what a row names is not changed' USING ERRCODE = 'foreign_key_violation';
END
$$;

CREATE TRIGGER work_keeps_its_base BEFORE UPDATE OF key, base ON work FOR EACH STATEMENT EXECUTE FUNCTION refuse_change();
CREATE TRIGGER point_keeps_its_sweep_and_work BEFORE UPDATE OF sweep_id, work_key ON point FOR EACH STATEMENT EXECUTE FUNCTION refuse_change();
CREATE TRIGGER scenario_keeps_its_name BEFORE UPDATE OF hash ON scenario FOR EACH STATEMENT EXECUTE FUNCTION refuse_change();
CREATE TRIGGER sweep_keeps_its_name BEFORE UPDATE OF id ON sweep FOR EACH STATEMENT EXECUTE FUNCTION refuse_change();
CREATE TRIGGER event_keeps_its_sweep BEFORE UPDATE OF sweep_id ON event FOR EACH STATEMENT EXECUTE FUNCTION refuse_change();

-- Writers of two kinds (store/src/engine/database.rs): what changes the state of work shares this lock, what changes several items,
-- points or sweeps has it alone. The lock is nearly always free, and then asking for it is no statement of its own.
CREATE FUNCTION share_the_writers_lock() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF NOT pg_try_advisory_xact_lock_shared(7237963465534699365) THEN
        PERFORM pg_advisory_xact_lock_shared(7237963465534699365);
    END IF;
    RETURN NULL;
END
$$;

CREATE TRIGGER work_is_written BEFORE INSERT OR DELETE OR UPDATE OF state, cancel_requested ON work
FOR EACH STATEMENT EXECUTE FUNCTION share_the_writers_lock();

-- A change of a work item's state has consequences for others: the turn of its owner, the counts, events and end of the sweeps that have it.
-- These rows are few, and all workers change them: if each did so in its own transaction, all would wait for each other. So a transaction
-- only notes what it changed, in a row of its own that is committed with the change, and these notes are applied in batches: by
-- whoever has committed one, as long as nobody else is applying some (store/src/engine/postgres.rs). Alone, a
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

-- A worker's role may change work, and neither turns nor sweeps (deploy/postgres/worker-role.sql): what follows from a change of work is
-- done in the name of the tables' owner.

-- All that follows at once from a change of a work item. One trigger, before its row is written: columns that are generated, conditions of
-- the table and conditions of triggers are prepared anew for each statement, which takes longer than all the rest of it, and a trigger
-- after the change reads both rows again.
CREATE FUNCTION follow_state() RETURNS trigger LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    -- What the columns mean, the table says.
    CASE NEW.state
        WHEN 'queued', 'waiting' THEN NEW.stage := 'queued';
        WHEN 'leased' THEN NEW.stage := 'running';
        WHEN 'dead' THEN NEW.stage := 'failed';
        WHEN 'done', 'failed', 'cancelled' THEN NEW.stage := NEW.state;
        ELSE RAISE EXCEPTION 'no work item has this state' USING ERRCODE = 'check_violation';
    END CASE;
    NEW.is_open := NEW.stage IN ('queued', 'running');
    NEW.stage_of_cancelled := CASE WHEN NEW.is_open AND NOT NEW.cancel_requested THEN 'cancelled' ELSE NEW.stage END;
    IF TG_OP = 'INSERT' THEN
        RETURN NEW;
    END IF;
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
    RETURN NEW;
END
$$;

CREATE TRIGGER work_changes BEFORE UPDATE OF state, held, cancel_requested ON work
FOR EACH ROW EXECUTE FUNCTION follow_state();

-- What is submitted is queued, and has all this by default.
CREATE TRIGGER work_begins BEFORE INSERT ON work FOR EACH ROW
WHEN (NEW.state <> 'queued' OR NEW.cancel_requested OR NEW.stage <> 'queued' OR NOT NEW.is_open OR NEW.stage_of_cancelled <> 'cancelled')
EXECUTE FUNCTION follow_state();

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

-- Whether there are transitions that have not been applied.
CREATE FUNCTION transitions_are_pending() RETURNS boolean LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    RETURN EXISTS (SELECT 1 FROM transition WHERE transaction >= (SELECT transaction FROM first_to_apply));
END
$$;

-- Applies what is pending, as `apply_transitions` does; whoever calls it has the lock of those who apply. Gives whether many were at work.
-- A batch of changes costs much the same whether it is a dozen or two: where so many come while one is applied, the next waits longer for
-- more. With 200 workers on two cores a few hundredths more points are finished, and results wait no longer for their answer.
CREATE FUNCTION apply_transitions_of_all() RETURNS boolean LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
DECLARE
    are_many      boolean := EXISTS (SELECT 1 FROM transition WHERE transaction >= (SELECT transaction FROM first_to_apply) OFFSET 3);
    are_very_many boolean := are_many
        AND EXISTS (SELECT 1 FROM transition WHERE transaction >= (SELECT transaction FROM first_to_apply) OFFSET 12);
BEGIN
    IF are_many THEN
        PERFORM pg_sleep(CASE WHEN are_very_many THEN 0.02 ELSE 0.01 END);
    END IF;
    PERFORM set_config('synchronous_commit', 'off', true);
    PERFORM apply_pending_transitions();
    RETURN are_many;
END
$$;

-- Hands out the next work item: of the owner whose turn it is the most urgent, of these the first in the order asked for. What others
-- are changing is skipped, and an owner with nothing else. The owners are gone through in the order of their turns, as far as the first
-- that has something: the order is that of the inner query. It takes the writers' lock itself, before it looks, and begins where the queues
-- do; where nothing is found, at their very beginning. A function, since its plan is kept.
CREATE FUNCTION claim_work(claiming_worker text, length_of_lease bigint, version_of_numbers bigint)
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

-- Ends a lease with a result, if that is the first of its work item. Gives what came of it: 'done'; 'lost', the lease; 'earlier' if there
-- is a result already; 'missing' and the name of a blob that is not reserved. Nothing is written but for the first.
CREATE FUNCTION finish_work(
    work_item bytea, token bigint, worker text, new_summary text, new_provenance text, new_artifacts json
) RETURNS text LANGUAGE plpgsql AS $$
DECLARE
    missing text;
    moment bigint;
BEGIN
    IF NOT pg_try_advisory_xact_lock_shared(7237963465534699365) THEN
        PERFORM pg_advisory_xact_lock_shared(7237963465534699365);
    END IF;
    SELECT now, (SELECT blob FROM json_to_recordset(new_artifacts) AS item (blob text)
                 WHERE NOT EXISTS (SELECT 1 FROM upload WHERE upload.blob = item.blob AND expires > now) LIMIT 1)
    FROM clock INTO moment, missing;
    UPDATE work SET
        state = 'done', progress = 1, error = NULL, checkpoint = NULL, lease_until = NULL, changed = moment
    WHERE key = work_item AND fencing_token = token AND lease_owner = worker AND state = 'leased' AND missing IS NULL
      AND NOT EXISTS (SELECT 1 FROM result WHERE work_key = work_item);
    IF NOT FOUND THEN
        RETURN CASE
            WHEN EXISTS (SELECT 1 FROM result WHERE work_key = work_item) THEN 'earlier'
            WHEN EXISTS (SELECT 1 FROM work WHERE key = work_item AND fencing_token = token AND lease_owner = worker AND state = 'leased')
            THEN 'missing ' || missing
            ELSE 'lost'
        END;
    END IF;
    INSERT INTO result (work_key, summary, provenance, created) VALUES (work_item, new_summary, new_provenance, moment);
    INSERT INTO artifact (work_key, name, media_type, blob, bytes, row_count)
    SELECT work_item, name, media_type, blob, bytes, row_count
    FROM json_to_recordset(new_artifacts) AS item (name text, media_type text, blob text, bytes bigint, row_count bigint);
    RETURN 'done';
END
$$;

-- Ends a lease with a result, as `finish_work`, and hands the next work item to the same worker, as `claim_work`, in one transaction; then
-- does what follows from both, as far as nobody else is at it. One message instead of four. It commits, and so is called by itself
-- and not in a transaction.
--
-- Gives what came of the result, and where that is 'done' the next work item, if one is ready.
CREATE PROCEDURE finish_and_claim(
    work_item bytea, token bigint, worker text, new_summary text, new_provenance text, new_artifacts json,
    length_of_lease bigint, version_of_numbers bigint,
    INOUT outcome text, INOUT key bytea, INOUT fencing_token bigint, INOUT base text, INOUT changes text, INOUT checkpoint text
) LANGUAGE plpgsql AS $$
DECLARE
    are_many boolean;
BEGIN
    outcome := finish_work(work_item, token, worker, new_summary, new_provenance, new_artifacts);
    IF outcome <> 'done' THEN
        RETURN;
    END IF;
    SELECT * FROM claim_work(worker, length_of_lease, version_of_numbers) INTO key, fencing_token, base, changes, checkpoint;
    COMMIT;
    -- Its own transitions are pending, unless somebody has applied them already.
    WHILE pg_try_advisory_xact_lock(7237963465534699366) LOOP
        BEGIN
            are_many := apply_transitions_of_all();
        EXCEPTION WHEN OTHERS THEN
            -- The result stands nevertheless, and the next one that comes applies what follows from it.
            RAISE WARNING 'what follows from changes of points is left to others: %', SQLERRM;
            RETURN;
        END;
        COMMIT;
        IF are_many THEN
            -- So that another one takes over: this one's worker waits for its work item.
            PERFORM pg_sleep(0.001);
        END IF;
        EXIT WHEN NOT transitions_are_pending();
    END LOOP;
END
$$;

-- One row: when somebody began to look last. Whoever claims looks once a second whether leases have run out or retries are due, and reads
-- all leases for it. Of many processes one does so for all.
CREATE TABLE expiry_look (
    at BIGINT NOT NULL
);

INSERT INTO expiry_look (at) VALUES (0);

-- Whether somebody has to look, who then is the one that asked: not if one has begun to within the pause. By a clock that was set back it is
-- time to look.
CREATE FUNCTION begin_to_look(pause bigint) RETURNS boolean LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    IF EXISTS (SELECT 1 FROM expiry_look CROSS JOIN clock WHERE at > now - pause AND at <= now) THEN
        RETURN false;
    END IF;
    PERFORM 1 FROM expiry_look FOR UPDATE SKIP LOCKED;
    IF NOT FOUND THEN
        RETURN false;
    END IF;
    UPDATE expiry_look SET at = now FROM clock;
    RETURN true;
END
$$;

-- Listeners are notified when a transaction commits, once for each (store/src/engine/notification.rs).
CREATE FUNCTION tell_of_work() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    NOTIFY drillsweep_work;
    RETURN NULL;
END
$$;

CREATE TRIGGER work_is_inserted AFTER INSERT ON work FOR EACH STATEMENT EXECUTE FUNCTION tell_of_work();

CREATE FUNCTION tell_of_sweeps() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    NOTIFY drillsweep_sweeps;
    RETURN NULL;
END
$$;

CREATE TRIGGER sweep_changes AFTER UPDATE OF version ON sweep FOR EACH STATEMENT EXECUTE FUNCTION tell_of_sweeps();

-- What came of it.

CREATE TABLE result (
    work_key   BYTEA   NOT NULL PRIMARY KEY REFERENCES work (key),
    -- Scalar results, a JSON object.
    summary    TEXT    NOT NULL,
    -- Where and how it was computed, a JSON object.
    provenance TEXT    NOT NULL,
    created    BIGINT  NOT NULL,
    -- Recomputed, it differs from the one before, or one before it did: the same numbers are promised. What differed is
    -- in its provenance.
    disagrees  BOOLEAN NOT NULL DEFAULT false,
    -- When the object store was found to have lost one of its tables. Such a result counts as none where it is asked
    -- whether work has to be done.
    damaged    BIGINT
);

CREATE INDEX result_disagrees ON result (work_key) WHERE disagrees;

-- The tables of a result, each a blob in the object store.
CREATE TABLE artifact (
    work_key   BYTEA   NOT NULL REFERENCES result (work_key) ON DELETE CASCADE,
    name       TEXT COLLATE "C" NOT NULL,
    media_type TEXT    NOT NULL,
    -- BLAKE3 of its bytes, in hexadecimal digits.
    blob       TEXT COLLATE "C" NOT NULL,
    bytes      BIGINT  NOT NULL,
    row_count  BIGINT  NOT NULL,
    -- When its blob was given up; the row tells that there was one.
    expired    BIGINT,
    PRIMARY KEY (work_key, name)
);

CREATE INDEX artifact_by_blob ON artifact (blob);

-- Blobs that are being written, or found to be there, for a row to come: they are not deleted before it is there. A row stays until it
-- has run out, for another worker may have reserved the same blob.
CREATE TABLE upload (
    blob    TEXT COLLATE "C" NOT NULL PRIMARY KEY,
    expires BIGINT NOT NULL
);

-- Blobs that are being deleted: nobody reserves one meanwhile.
CREATE TABLE removal (
    blob    TEXT COLLATE "C" NOT NULL PRIMARY KEY,
    expires BIGINT NOT NULL
);

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

-- The same for all of a JSON array's. Gives those that are reserved.
CREATE FUNCTION reserve_blobs(names json, length_of_reservation bigint) RETURNS SETOF text LANGUAGE plpgsql AS $$
BEGIN
    IF NOT pg_try_advisory_xact_lock_shared(7237963465534699365) THEN
        PERFORM pg_advisory_xact_lock_shared(7237963465534699365);
    END IF;
    -- In one order, so that no two wait for each other.
    RETURN QUERY
    INSERT INTO upload (blob, expires)
    SELECT name, now + length_of_reservation FROM clock CROSS JOIN json_array_elements_text(names) AS wanted (name)
    WHERE NOT EXISTS (SELECT 1 FROM removal WHERE removal.blob = name AND expires > now)
    ORDER BY name
    ON CONFLICT (blob) DO UPDATE SET expires = greatest(upload.expires, excluded.expires)
    RETURNING blob;
END
$$;

-- Who computes, and who may ask.

CREATE TABLE worker (
    id              TEXT COLLATE "C" NOT NULL PRIMARY KEY,
    host            TEXT COLLATE "C" NOT NULL,
    process         BIGINT  NOT NULL,
    version         TEXT    NOT NULL,
    physics_version BIGINT  NOT NULL,
    started         BIGINT  NOT NULL,
    last_seen       BIGINT  NOT NULL
);

-- How fast the machines are that workers run on, so that a plan can tell processor times. What a speed is, only the
-- simulation knows.
CREATE TABLE machine_speed (
    host            TEXT COLLATE "C" NOT NULL,
    physics_version BIGINT  NOT NULL,
    speed           TEXT    NOT NULL,
    measured        BIGINT  NOT NULL,
    PRIMARY KEY (host, physics_version)
);

-- The last collection of what need not be kept any more: one row, once there has been one.
CREATE TABLE collection (
    id      BIGINT  NOT NULL PRIMARY KEY CHECK (id = 1),
    started BIGINT  NOT NULL,
    -- When one ended last, and what it deleted, a JSON object.
    ended   BIGINT,
    deleted TEXT
);

-- Who may talk to the service. Only hashes: who reads the database learns no token.
CREATE TABLE token (
    -- The beginning of the hash in hexadecimal digits.
    id        TEXT COLLATE "C" NOT NULL PRIMARY KEY,
    -- BLAKE3 of the token's text. A token has 256 random bits, so that a slow hash would gain nothing.
    hash      BYTEA   NOT NULL UNIQUE,
    owner     TEXT COLLATE "C" NOT NULL,
    name      TEXT COLLATE "C",
    scope     TEXT COLLATE "C" NOT NULL CHECK (scope IN ('read', 'submit', 'admin')),
    created   BIGINT  NOT NULL,
    expires   BIGINT,
    revoked   BIGINT,
    -- To within an hour.
    last_used BIGINT
);

-- Browsers that have logged in by a token. A session is valid as long as its token is, and not after it has expired itself.
CREATE TABLE session (
    -- BLAKE3 of what the browser keeps, which has 256 random bits.
    hash     BYTEA NOT NULL PRIMARY KEY,
    token_id TEXT COLLATE "C" NOT NULL REFERENCES token (id) ON DELETE CASCADE,
    created  BIGINT NOT NULL,
    expires  BIGINT NOT NULL
);

CREATE INDEX session_by_token ON session (token_id);

-- The clock: milliseconds since the epoch, the same throughout a statement. Statements read the time from here and from nowhere else.
CREATE VIEW clock AS SELECT floor(extract(epoch FROM statement_timestamp()) * 1000)::bigint AS now;

-- The class of an error; one that is not JSON has none.
CREATE FUNCTION class_of_error(error text) RETURNS text LANGUAGE plpgsql STABLE AS $$
BEGIN
    RETURN error::json ->> 'class';
EXCEPTION WHEN others THEN
    RETURN NULL;
END
$$;
