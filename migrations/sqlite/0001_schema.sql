-- What was asked (sweep, point), what must be computed (work, by content hash), what came of it (result, artifact).
-- Times are integer milliseconds since the epoch, from the database's clock. Columns that hold yes or no are 0 or 1.

-- What was asked: sweeps and their points.

CREATE TABLE sweep (
    -- A UUID of version 7: sorted by it, sweeps are in the order of their submission.
    id                      TEXT    NOT NULL PRIMARY KEY,
    name                    TEXT,
    owner                   TEXT    NOT NULL,
    -- As it was submitted, JSON.
    request                 TEXT    NOT NULL,
    -- Higher goes first.
    priority                INTEGER NOT NULL,
    -- A JSON array of texts.
    tags                    TEXT    NOT NULL DEFAULT '[]',
    cancelled               INTEGER NOT NULL DEFAULT 0,
    -- The ordinal up to which the work of a cancelled sweep is cancelled; none once all of it is.
    cancelled_to            INTEGER,
    -- Since when nobody sees it: while its points are being stored, or taken away. What stays so for long was left behind by a
    -- process that died, and is taken away.
    hidden                  INTEGER,
    -- Its points are not handed out, but for those that another live sweep wants.
    paused                  INTEGER NOT NULL DEFAULT 0,
    -- All that belongs to it is kept.
    pinned                  INTEGER NOT NULL DEFAULT 0,
    -- It wants its points computed though they have results.
    refreshes               INTEGER NOT NULL DEFAULT 0,
    -- Raised with every change of one of its points; the number of its last event.
    version                 INTEGER NOT NULL DEFAULT 1,
    -- Raised with every change that somebody asked for.
    revision                INTEGER NOT NULL DEFAULT 1,
    -- Points by the state of their work, kept by the trigger `work_changes_state`: counting them at every look would cost
    -- more than computing them at some size of sweep.
    points                  INTEGER NOT NULL,
    points_queued           INTEGER NOT NULL DEFAULT 0,
    points_running          INTEGER NOT NULL DEFAULT 0,
    points_done             INTEGER NOT NULL DEFAULT 0,
    points_failed           INTEGER NOT NULL DEFAULT 0,
    points_cancelled        INTEGER NOT NULL DEFAULT 0,
    -- Reference runs by the state of their work, kept alike.
    verifications           INTEGER NOT NULL DEFAULT 0,
    verifications_queued    INTEGER NOT NULL DEFAULT 0,
    verifications_running   INTEGER NOT NULL DEFAULT 0,
    verifications_done      INTEGER NOT NULL DEFAULT 0,
    verifications_failed    INTEGER NOT NULL DEFAULT 0,
    verifications_cancelled INTEGER NOT NULL DEFAULT 0,
    created                 INTEGER NOT NULL,
    -- When the last of its points and reference runs became final; none while one is not.
    finished                INTEGER,
    -- When it is to be deleted, once it is finished and unless it is pinned.
    expires                 INTEGER
) STRICT;

CREATE INDEX sweep_by_owner ON sweep (owner, id);
-- What was begun and is to be brought to its end.
CREATE INDEX sweep_half_cancelled ON sweep (id) WHERE cancelled_to IS NOT NULL;
CREATE INDEX sweep_hidden ON sweep (hidden) WHERE hidden IS NOT NULL;

-- The requests by which points were added to a sweep, a row each: in the row of the sweep, which is written with every change
-- of one of its points, they would make each of these writes as long as all of them.
CREATE TABLE appended (
    sweep_id TEXT    NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    -- From 1, in the order in which they came.
    number   INTEGER NOT NULL,
    request  TEXT    NOT NULL,
    PRIMARY KEY (sweep_id, number)
) STRICT, WITHOUT ROWID;

-- Points, and next to them the reference runs that verify some: cancelling, pausing, retrying, priority and retention go by the
-- work behind a row, and hold for both. Counts and listings tell them apart by `verifies`.
CREATE TABLE point (
    sweep_id   TEXT    NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    -- 0: the point with this ordinal. 1: the reference run that verifies that point.
    verifies   INTEGER NOT NULL CHECK (verifies IN (0, 1)),
    -- From 1.
    ordinal    INTEGER NOT NULL,
    -- The swept parameters, a JSON object.
    parameters TEXT    NOT NULL,
    -- A sweep may have the same work at several points, and several sweeps may.
    work_key   BLOB    NOT NULL REFERENCES work (key),
    PRIMARY KEY (sweep_id, verifies, ordinal)
) STRICT, WITHOUT ROWID;

CREATE INDEX point_by_work ON point (work_key);

-- What a client's idempotency key was used for, so that a request that is sent twice is stored once.
CREATE TABLE idempotency (
    owner     TEXT    NOT NULL,
    key       TEXT    NOT NULL,
    -- Of the request: under the same key another one is refused.
    body_hash BLOB    NOT NULL,
    sweep_id  TEXT    NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    created   INTEGER NOT NULL,
    PRIMARY KEY (owner, key)
) STRICT, WITHOUT ROWID;

CREATE INDEX idempotency_by_sweep ON idempotency (sweep_id);

-- What must be computed: the queue.

-- The texts that work items change: a hundred thousand points of one sweep share one instead of repeating it.
CREATE TABLE scenario (
    -- BLAKE3 of the text.
    hash BLOB NOT NULL PRIMARY KEY,
    text TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE work (
    -- Content hash: equal keys, equal results.
    key              BLOB    NOT NULL PRIMARY KEY,
    -- Version of the numbers that the key was made for; a worker takes only work of its own.
    physics_version  INTEGER NOT NULL,
    -- In whose turn it is handed out.
    owner            TEXT    NOT NULL,
    -- Which states there are, and which ways from one to another, is told by `TRANSITIONS` in store/src/work/state.rs.
    state            TEXT    NOT NULL CHECK (state IN ('waiting', 'queued', 'leased', 'done', 'failed', 'dead', 'cancelled')),
    -- How the sweeps that have it count it.
    stage            TEXT    NOT NULL GENERATED ALWAYS AS (
        CASE state WHEN 'waiting' THEN 'queued' WHEN 'leased' THEN 'running' WHEN 'dead' THEN 'failed' ELSE state END
    ) VIRTUAL,
    -- Still to be computed, or under way. All else is final, and changes only if somebody asks for it.
    is_open          INTEGER NOT NULL GENERATED ALWAYS AS (stage IN ('queued', 'running')) VIRTUAL,
    -- How cancelled sweeps that have it count it: what goes on for others is cancelled for them, what is being stopped has still to
    -- end.
    stage_of_cancelled TEXT  NOT NULL GENERATED ALWAYS AS (
        CASE WHEN is_open AND NOT cancel_requested THEN 'cancelled' ELSE stage END
    ) VIRTUAL,
    -- Wanted by paused sweeps only: not handed out until one of them goes on.
    held             INTEGER NOT NULL DEFAULT 0,
    -- Within its owner the most urgent goes first, then the least place in the order asked for.
    priority         INTEGER NOT NULL,
    vtime            INTEGER NOT NULL,
    -- When a retry is due.
    ready_at         INTEGER NOT NULL,
    -- Grows with every claim, and never falls: a write under an older one changes nothing.
    fencing_token    INTEGER NOT NULL DEFAULT 0,
    -- How often a worker has started it and not given it back.
    attempts         INTEGER NOT NULL DEFAULT 0,
    -- Deaths of workers, and failures of disk, object store or database, after which it is given up.
    crash_count      INTEGER NOT NULL DEFAULT 0,
    failure_count    INTEGER NOT NULL DEFAULT 0,
    lease_owner      TEXT,
    lease_until      INTEGER,
    -- How long the lease is that its worker was given or has renewed: one that ends later than that from now was given before
    -- the clock was set back.
    lease_ms         INTEGER NOT NULL DEFAULT 3600000,
    -- No sweep wants it any more; its worker learns it with the next renewal.
    cancel_requested INTEGER NOT NULL DEFAULT 0,
    -- Simulated time over duration, 0 to 1.
    progress         REAL    NOT NULL DEFAULT 0,
    -- Why it failed, JSON.
    error            TEXT,
    created          INTEGER NOT NULL,
    -- When the state last changed. Every statement that changes the state sets it.
    changed          INTEGER NOT NULL,
    -- The blob that a suspended run goes on from; none for one that begins at its start.
    checkpoint       TEXT,
    base             BLOB REFERENCES scenario (hash),
    -- What the work item has in place of the base's values: a JSON object by path.
    changes          TEXT    NOT NULL DEFAULT '{}',
    -- What is known of the worker that has the work, should it be heard of no more: how full its memory was, or how its process ended.
    worker_note      TEXT
) STRICT;

-- Only the rows that a statement looks for: these indexes stay small however many points are finished.
CREATE INDEX work_ready ON work (physics_version, owner, priority DESC, vtime, key) WHERE state = 'queued' AND held = 0;
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

-- Work goes its ways and no others, whichever statement moves it.
CREATE TRIGGER work_keeps_to_its_transitions AFTER UPDATE OF state ON work
WHEN NEW.state <> OLD.state AND NOT CASE OLD.state
         WHEN 'queued'  THEN NEW.state IN ('leased', 'done', 'failed', 'cancelled')
         WHEN 'leased'  THEN NEW.state IN ('waiting', 'queued', 'done', 'failed', 'dead', 'cancelled')
         WHEN 'waiting' THEN NEW.state IN ('queued', 'done', 'failed', 'cancelled')
         ELSE NEW.state = 'queued'
     END
BEGIN
    SELECT RAISE(ABORT, 'a work item cannot go from its state to that one');
END;

-- Owners take turns (start-time fair queueing): the one whose virtual time is least is served, and pays for it. Within an
-- owner the most urgent goes first, then the order asked for: work.vtime is a place in that order.
CREATE TABLE owner_turn (
    owner TEXT    NOT NULL PRIMARY KEY,
    vtime INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- Idle time is not saved up: who comes back has missed all turns but the one before the latest.
CREATE TRIGGER work_takes_a_turn AFTER UPDATE OF state ON work WHEN NEW.state = 'leased' AND OLD.state <> 'leased'
BEGIN
    UPDATE owner_turn SET vtime = max(vtime, (SELECT max(vtime) FROM owner_turn) - 1000) + 1000
    WHERE owner = NEW.owner;
END;

-- Changes of state, for those who watch a sweep.
CREATE TABLE event (
    sweep_id TEXT    NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    -- The sweep's version after the change.
    seq      INTEGER NOT NULL,
    -- The new state of the work.
    kind     TEXT    NOT NULL,
    work_key BLOB    NOT NULL,
    at       INTEGER NOT NULL,
    PRIMARY KEY (sweep_id, seq)
) STRICT, WITHOUT ROWID;

-- A change of a work item's state reaches every sweep that has it in the same transaction, whichever statement
-- made it: counts, version, end, event. A sweep may have the same work item at several points, and verify points by it; it
-- is finished when neither its points nor its reference runs have an open one. A cancelled sweep counts by `stage_of_cancelled`, and
-- of what others compute it hears only the outcome.
--
-- The version of a finished sweep is one more than the number of its last event: who has seen that event, and not the end, is
-- told from who has seen both.
CREATE TRIGGER work_changes_state AFTER UPDATE OF state, cancel_requested ON work
WHEN NEW.state <> OLD.state OR NEW.stage_of_cancelled <> OLD.stage_of_cancelled
BEGIN
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
    FROM (SELECT sweep_id, sum(verifies = 0) AS points, sum(verifies) AS verifications
          FROM point WHERE work_key = NEW.key GROUP BY sweep_id) AS share,
         (SELECT of_cancelled,
                 (after = 'queued') - (before = 'queued')       AS queued,
                 (after = 'running') - (before = 'running')     AS running,
                 (after = 'done') - (before = 'done')           AS done,
                 (after = 'failed') - (before = 'failed')       AS failed,
                 (after = 'cancelled') - (before = 'cancelled') AS cancelled
          FROM (SELECT 0 AS of_cancelled, OLD.stage AS before, NEW.stage AS after
                WHERE NEW.state <> OLD.state
                UNION ALL
                SELECT 1, OLD.stage_of_cancelled, NEW.stage_of_cancelled
                WHERE NEW.stage_of_cancelled <> OLD.stage_of_cancelled
                   OR (NEW.state <> OLD.state AND NOT NEW.is_open))) AS step
    WHERE sweep.id = share.sweep_id AND sweep.cancelled = step.of_cancelled;

    INSERT INTO event (sweep_id, seq, kind, work_key, at)
    SELECT id, version,
           CASE WHEN cancelled <> 0 AND NEW.stage_of_cancelled = 'cancelled' THEN 'cancelled' ELSE NEW.state END,
           NEW.key, NEW.changed
    FROM sweep
    WHERE id IN (SELECT sweep_id FROM point WHERE work_key = NEW.key)
      AND CASE cancelled
              WHEN 0 THEN NEW.state <> OLD.state
              ELSE NEW.stage_of_cancelled <> OLD.stage_of_cancelled OR (NEW.state <> OLD.state AND NOT NEW.is_open)
          END;

    UPDATE sweep SET version = version + 1
    WHERE finished IS NOT NULL
      AND id IN (SELECT sweep_id FROM point WHERE work_key = NEW.key)
      AND EXISTS (SELECT 1 FROM event WHERE event.sweep_id = sweep.id AND event.seq = sweep.version);
END;

-- What came of it.

CREATE TABLE result (
    work_key   BLOB    NOT NULL PRIMARY KEY REFERENCES work (key),
    -- Scalar results, a JSON object.
    summary    TEXT    NOT NULL,
    -- Where and how it was computed, a JSON object.
    provenance TEXT    NOT NULL,
    created    INTEGER NOT NULL,
    -- Recomputed, it differs from the one before, or one before it did: the same numbers are promised. What differed is
    -- in its provenance.
    disagrees  INTEGER NOT NULL DEFAULT 0,
    -- When the object store was found to have lost one of its tables. Such a result counts as none where it is asked
    -- whether work has to be done.
    damaged    INTEGER
) STRICT;

CREATE INDEX result_disagrees ON result (work_key) WHERE disagrees <> 0;

-- The tables of a result, each a blob in the object store.
CREATE TABLE artifact (
    work_key   BLOB    NOT NULL REFERENCES result (work_key) ON DELETE CASCADE,
    name       TEXT    NOT NULL,
    media_type TEXT    NOT NULL,
    -- BLAKE3 of its bytes, in hexadecimal digits.
    blob       TEXT    NOT NULL,
    bytes      INTEGER NOT NULL,
    row_count  INTEGER NOT NULL,
    -- When its blob was given up; the row tells that there was one.
    expired    INTEGER,
    PRIMARY KEY (work_key, name)
) STRICT, WITHOUT ROWID;

CREATE INDEX artifact_by_blob ON artifact (blob);

-- Blobs that are being written, or found to be there, for a row to come: they are not deleted before it is there. A row stays until it
-- has run out, for another worker may have reserved the same blob.
CREATE TABLE upload (
    blob    TEXT    NOT NULL PRIMARY KEY,
    expires INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- Blobs that are being deleted: nobody reserves one meanwhile.
CREATE TABLE removal (
    blob    TEXT    NOT NULL PRIMARY KEY,
    expires INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- Who computes, and who may ask.

CREATE TABLE worker (
    id              TEXT    NOT NULL PRIMARY KEY,
    host            TEXT    NOT NULL,
    process         INTEGER NOT NULL,
    version         TEXT    NOT NULL,
    physics_version INTEGER NOT NULL,
    started         INTEGER NOT NULL,
    last_seen       INTEGER NOT NULL
) STRICT;

-- How fast the machines are that workers run on, so that a plan can tell processor times. What a speed is, only the
-- simulation knows.
CREATE TABLE machine_speed (
    host            TEXT    NOT NULL,
    physics_version INTEGER NOT NULL,
    speed           TEXT    NOT NULL,
    measured        INTEGER NOT NULL,
    PRIMARY KEY (host, physics_version)
) STRICT;

-- The last collection of what need not be kept any more: one row, once there has been one.
CREATE TABLE collection (
    id      INTEGER NOT NULL PRIMARY KEY CHECK (id = 1),
    started INTEGER NOT NULL,
    -- When one ended last, and what it deleted, a JSON object.
    ended   INTEGER,
    deleted TEXT
) STRICT;

-- Who may talk to the service. Only hashes: who reads the database learns no token.
CREATE TABLE token (
    -- The beginning of the hash in hexadecimal digits.
    id        TEXT    NOT NULL PRIMARY KEY,
    -- BLAKE3 of the token's text. A token has 256 random bits, so that a slow hash would gain nothing.
    hash      BLOB    NOT NULL UNIQUE,
    owner     TEXT    NOT NULL,
    name      TEXT,
    scope     TEXT    NOT NULL CHECK (scope IN ('read', 'submit', 'admin')),
    created   INTEGER NOT NULL,
    expires   INTEGER,
    revoked   INTEGER,
    -- To within an hour.
    last_used INTEGER
) STRICT;

-- Browsers that have logged in by a token. A session is valid as long as its token is, and not after it has expired itself.
CREATE TABLE session (
    -- BLAKE3 of what the browser keeps, which has 256 random bits.
    hash     BLOB NOT NULL PRIMARY KEY,
    token_id TEXT NOT NULL REFERENCES token (id) ON DELETE CASCADE,
    created  INTEGER NOT NULL,
    expires  INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

CREATE INDEX session_by_token ON session (token_id);

-- The clock: milliseconds since the epoch. Statements read the time from here and from nowhere else.
CREATE VIEW clock AS SELECT CAST((julianday('now') - 2440587.5) * 86400000.0 AS INTEGER) AS now;
