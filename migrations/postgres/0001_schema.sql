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
    -- Points by the state of their work, kept by the trigger `work_changes_state`: counting them at every look would cost
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
    -- Which states there are, and which ways from one to another, is told by `TRANSITIONS` in store/src/state.rs.
    state            TEXT COLLATE "C" NOT NULL CHECK (state IN ('waiting', 'queued', 'leased', 'done', 'failed', 'dead', 'cancelled')),
    -- How the sweeps that have it count it.
    stage            TEXT    COLLATE "C" NOT NULL GENERATED ALWAYS AS (
        CASE state WHEN 'waiting' THEN 'queued' WHEN 'leased' THEN 'running' WHEN 'dead' THEN 'failed' ELSE state END
    ) STORED,
    -- Still to be computed, or under way. All else is final, and changes only if somebody asks for it.
    is_open          BOOLEAN NOT NULL GENERATED ALWAYS AS (state IN ('waiting', 'queued', 'leased')) STORED,
    -- How cancelled sweeps that have it count it: what goes on for others is cancelled for them, what is being stopped has still to
    -- end.
    stage_of_cancelled TEXT  COLLATE "C" NOT NULL GENERATED ALWAYS AS (
        CASE WHEN state IN ('waiting', 'queued', 'leased') AND NOT cancel_requested THEN 'cancelled'
             WHEN state = 'waiting' THEN 'queued' WHEN state = 'leased' THEN 'running' WHEN state = 'dead' THEN 'failed'
             ELSE state END
    ) STORED,
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
    base             BYTEA REFERENCES scenario (hash),
    -- What the work item has in place of the base's values: a JSON object by path.
    changes          TEXT    NOT NULL DEFAULT '{}',
    -- What is known of the worker that has the work, should it be heard of no more: how full its memory was, or how its process ended.
    worker_note      TEXT
) WITH (autovacuum_vacuum_scale_factor = 0.02, autovacuum_analyze_scale_factor = 0.02);

-- Only the rows that a statement looks for: these indexes stay small however many points are finished.
CREATE INDEX work_ready ON work (physics_version, owner, priority DESC, vtime, key) WHERE state = 'queued' AND NOT held;
CREATE INDEX work_leased ON work (lease_until) WHERE state = 'leased';
CREATE INDEX work_waiting ON work (ready_at) WHERE state = 'waiting';
CREATE INDEX work_open ON work (vtime) WHERE is_open;
CREATE INDEX work_open_by_owner ON work (owner, vtime) WHERE is_open;
-- Whether a version of the numbers is waited for.
CREATE INDEX work_open_by_version ON work (physics_version) WHERE is_open;
-- What was given up, the latest first.
CREATE INDEX work_given_up ON work (changed) WHERE stage = 'failed';
-- Whether a base is in use: the garbage collector asks it of every base, and so does the reference when one is deleted.
CREATE INDEX work_by_base ON work (base);

-- Points, and beside them the reference runs that verify some: cancelling, pausing, retrying, priority and retention go by the
-- work behind a row, and hold for both. Counts and listings tell them apart by `verifies`.
CREATE TABLE point (
    sweep_id   TEXT COLLATE "C" NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    -- Whether it is the reference run that verifies the point with this ordinal, and not that point.
    verifies   BOOLEAN NOT NULL,
    -- From 1.
    ordinal    BIGINT  NOT NULL,
    -- The swept parameters, a JSON object.
    parameters TEXT    NOT NULL,
    -- A sweep may have the same work at several points, and several sweeps may.
    work_key   BYTEA   NOT NULL REFERENCES work (key),
    PRIMARY KEY (sweep_id, verifies, ordinal)
);

CREATE INDEX point_by_work ON point (work_key);

-- Writers of two kinds (store/src/database.rs): what changes the state of work shares this lock, what changes several items,
-- points or sweeps has it alone.
CREATE FUNCTION share_the_writers_lock() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    PERFORM pg_advisory_xact_lock_shared(7237963465534699365);
    RETURN NULL;
END
$$;

CREATE TRIGGER work_is_written BEFORE INSERT OR DELETE OR UPDATE OF state, cancel_requested ON work
FOR EACH STATEMENT EXECUTE FUNCTION share_the_writers_lock();

-- Work goes its ways and no others, whichever statement moves it.
CREATE FUNCTION refuse_transition() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    RAISE EXCEPTION 'a work item cannot go from its state to that one';
END
$$;

CREATE TRIGGER work_keeps_to_its_transitions AFTER UPDATE OF state ON work FOR EACH ROW
WHEN (NEW.state <> OLD.state AND NOT CASE OLD.state
         WHEN 'queued'  THEN NEW.state IN ('leased', 'done', 'failed', 'cancelled')
         WHEN 'leased'  THEN NEW.state IN ('waiting', 'queued', 'done', 'failed', 'dead', 'cancelled')
         WHEN 'waiting' THEN NEW.state IN ('queued', 'done', 'failed', 'cancelled')
         ELSE NEW.state = 'queued'
     END)
EXECUTE FUNCTION refuse_transition();

-- A worker's role may change work, and neither turns nor sweeps (deploy/postgres/worker-role.sql): what follows from a change of work is
-- done in the name of the tables' owner.

-- Owners take turns (start-time fair queueing): the one whose virtual time is least is served, and pays for it. Within an
-- owner the most urgent goes first, then the order asked for: work.vtime is a place in that order.
CREATE TABLE owner_turn (
    owner TEXT COLLATE "C" NOT NULL PRIMARY KEY,
    vtime BIGINT NOT NULL
) WITH (fillfactor = 50);

-- Idle time is not saved up: who comes back has missed all turns but the one before the latest. Of claims at the same moment each
-- pays for its own turn.
CREATE FUNCTION take_a_turn() RETURNS trigger LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    UPDATE owner_turn SET vtime = greatest(vtime, (SELECT max(vtime) FROM owner_turn) - 1000) + 1000
    WHERE owner = NEW.owner;
    RETURN NULL;
END
$$;

CREATE TRIGGER work_takes_a_turn AFTER UPDATE OF state ON work FOR EACH ROW
WHEN (NEW.state = 'leased' AND OLD.state <> 'leased')
EXECUTE FUNCTION take_a_turn();

-- Changes of state, for those who watch a sweep.
CREATE TABLE event (
    sweep_id TEXT COLLATE "C" NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    -- The sweep's version after the change.
    seq      BIGINT NOT NULL,
    -- The new state of the work.
    kind     TEXT COLLATE "C" NOT NULL,
    work_key BYTEA  NOT NULL,
    at       BIGINT NOT NULL,
    PRIMARY KEY (sweep_id, seq)
);

-- A change of a work item's state reaches every sweep that has it in the same transaction, whichever statement
-- made it: counts, version, end, event. A sweep may have the same work item at several points, and verify points by it; it
-- is finished when neither its points nor its reference runs have an open one. A cancelled sweep counts by `stage_of_cancelled`, and
-- of what others compute it hears only the outcome.
--
-- The version of a finished sweep is one more than the number of its last event: who has seen that event, and not the end, is
-- told from who has seen both.
--
-- The sweeps are locked by their identifiers' order before they are changed, so that two work items of the same two sweeps do not
-- wait for each other. An event's number is taken under that lock, which ends with the transaction: nobody sees a later event
-- before an earlier one.
CREATE FUNCTION tell_the_sweeps() RETURNS trigger LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    PERFORM 1 FROM sweep WHERE id IN (SELECT sweep_id FROM point WHERE work_key = NEW.key)
    ORDER BY id FOR NO KEY UPDATE;

    UPDATE sweep SET
        version                 = version + 1,
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
        finished                = CASE
            WHEN points_queued + points_running + verifications_queued + verifications_running
                 + (share.points + share.verifications) * (step.queued + step.running) > 0
            THEN NULL
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
                   OR (NEW.state <> OLD.state AND NOT NEW.is_open)) AS stages) AS step
    WHERE sweep.id = share.sweep_id AND sweep.cancelled = step.of_cancelled;

    INSERT INTO event (sweep_id, seq, kind, work_key, at)
    SELECT id, version,
           CASE WHEN cancelled AND NEW.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE NEW.state END,
           NEW.key, NEW.changed
    FROM sweep
    WHERE id IN (SELECT sweep_id FROM point WHERE work_key = NEW.key)
      AND CASE WHEN cancelled
               THEN NEW.stage_of_cancelled <> OLD.stage_of_cancelled OR (NEW.state <> OLD.state AND NOT NEW.is_open)
               ELSE NEW.state <> OLD.state
          END;

    UPDATE sweep SET version = version + 1
    WHERE finished IS NOT NULL
      AND id IN (SELECT sweep_id FROM point WHERE work_key = NEW.key)
      AND EXISTS (SELECT 1 FROM event WHERE event.sweep_id = sweep.id AND event.seq = sweep.version);
    RETURN NULL;
END
$$;

-- At the end of the transaction, unless that runs alone: the sweep's row is what all its workers wait for, and is locked for no longer
-- than a commit takes.
CREATE CONSTRAINT TRIGGER work_changes_state AFTER UPDATE OF state, cancel_requested ON work
DEFERRABLE INITIALLY DEFERRED FOR EACH ROW
WHEN (NEW.state <> OLD.state OR NEW.stage_of_cancelled <> OLD.stage_of_cancelled)
EXECUTE FUNCTION tell_the_sweeps();

-- Listeners are notified when a transaction commits, once for each (store/src/notification.rs).
CREATE FUNCTION tell_of_work() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    NOTIFY drillsweep_work;
    RETURN NULL;
END
$$;

CREATE TRIGGER work_is_inserted AFTER INSERT ON work FOR EACH STATEMENT EXECUTE FUNCTION tell_of_work();

CREATE TRIGGER work_is_queued AFTER UPDATE OF state, held ON work FOR EACH ROW
WHEN (NEW.state = 'queued' AND NOT NEW.held AND (OLD.state <> 'queued' OR OLD.held))
EXECUTE FUNCTION tell_of_work();

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
