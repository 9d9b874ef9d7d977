-- What was asked (sweep, point), what must be computed (work, by content hash), what came of it (result, artifact).
-- Times are integer milliseconds since the epoch, from the database's clock.

CREATE TABLE sweep (
    id               TEXT    NOT NULL PRIMARY KEY,
    name             TEXT,
    owner            TEXT    NOT NULL,
    request          TEXT    NOT NULL,
    priority         INTEGER NOT NULL,
    cancelled        INTEGER NOT NULL DEFAULT 0,
    -- Raised with every change of one of its points; the number of its last event.
    version          INTEGER NOT NULL DEFAULT 1,
    -- Points by the state of their work, kept by the trigger below: counting them at every look would cost more
    -- than computing them at some size of sweep.
    points           INTEGER NOT NULL,
    points_queued    INTEGER NOT NULL DEFAULT 0,
    points_running   INTEGER NOT NULL DEFAULT 0,
    points_done      INTEGER NOT NULL DEFAULT 0,
    points_failed    INTEGER NOT NULL DEFAULT 0,
    points_cancelled INTEGER NOT NULL DEFAULT 0,
    created          INTEGER NOT NULL,
    -- When its last point became final; none while one is not.
    finished         INTEGER
) STRICT;

CREATE INDEX sweep_by_owner ON sweep (owner, id);

CREATE TABLE work (
    key              BLOB    NOT NULL PRIMARY KEY,
    physics_version  INTEGER NOT NULL,
    owner            TEXT    NOT NULL,
    state            TEXT    NOT NULL CHECK (state IN ('waiting', 'queued', 'leased', 'done', 'failed', 'dead', 'cancelled')),
    priority         INTEGER NOT NULL,
    vtime            INTEGER NOT NULL,
    ready_at         INTEGER NOT NULL,
    -- Fencing token: it never falls.
    attempt          INTEGER NOT NULL DEFAULT 0,
    -- What people see: attempts that were not given back untried.
    starts           INTEGER NOT NULL DEFAULT 0,
    crash_count      INTEGER NOT NULL DEFAULT 0,
    failure_count    INTEGER NOT NULL DEFAULT 0,
    lease_owner      TEXT,
    lease_until      INTEGER,
    cancel_requested INTEGER NOT NULL DEFAULT 0,
    progress         REAL    NOT NULL DEFAULT 0,
    error            TEXT,
    created          INTEGER NOT NULL,
    -- When the state last changed. Every statement that changes the state sets it.
    changed          INTEGER NOT NULL,
    scenario         TEXT    NOT NULL
) STRICT;

-- Only the rows that a statement looks for: these indexes stay small however many points are finished.
CREATE INDEX work_ready ON work (physics_version, priority DESC, vtime, key) WHERE state = 'queued';
CREATE INDEX work_leased ON work (lease_until) WHERE state = 'leased';
CREATE INDEX work_waiting ON work (ready_at) WHERE state = 'waiting';
CREATE INDEX work_open ON work (vtime) WHERE state IN ('waiting', 'queued', 'leased');
CREATE INDEX work_open_by_owner ON work (owner, vtime) WHERE state IN ('waiting', 'queued', 'leased');

CREATE TABLE point (
    sweep_id   TEXT    NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    ordinal    INTEGER NOT NULL,
    parameters TEXT    NOT NULL,
    work_key   BLOB    NOT NULL REFERENCES work (key),
    PRIMARY KEY (sweep_id, ordinal)
) STRICT, WITHOUT ROWID;

CREATE INDEX point_by_work ON point (work_key);

CREATE TABLE result (
    work_key   BLOB    NOT NULL PRIMARY KEY REFERENCES work (key),
    summary    TEXT    NOT NULL,
    provenance TEXT    NOT NULL,
    created    INTEGER NOT NULL
) STRICT;

CREATE TABLE artifact (
    work_key   BLOB    NOT NULL REFERENCES result (work_key) ON DELETE CASCADE,
    name       TEXT    NOT NULL,
    media_type TEXT    NOT NULL,
    blob       TEXT    NOT NULL,
    bytes      INTEGER NOT NULL,
    row_count  INTEGER NOT NULL,
    PRIMARY KEY (work_key, name)
) STRICT, WITHOUT ROWID;

CREATE INDEX artifact_by_blob ON artifact (blob);

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

CREATE TABLE idempotency (
    owner     TEXT    NOT NULL,
    key       TEXT    NOT NULL,
    body_hash BLOB    NOT NULL,
    sweep_id  TEXT    NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    created   INTEGER NOT NULL,
    PRIMARY KEY (owner, key)
) STRICT, WITHOUT ROWID;

CREATE INDEX idempotency_by_sweep ON idempotency (sweep_id);

CREATE TABLE worker (
    id              TEXT    NOT NULL PRIMARY KEY,
    host            TEXT    NOT NULL,
    process         INTEGER NOT NULL,
    version         TEXT    NOT NULL,
    physics_version INTEGER NOT NULL,
    started         INTEGER NOT NULL,
    last_seen       INTEGER NOT NULL
) STRICT;

-- A change of a work item's state reaches every sweep that has it in the same transaction, whichever statement
-- made it: counts, version, end, event. A sweep may have the same work item at several points.
CREATE TRIGGER work_changes_state AFTER UPDATE OF state ON work WHEN NEW.state <> OLD.state
BEGIN
    UPDATE sweep SET
        version          = version + 1,
        points_queued    = points_queued + share.points
                           * ((NEW.state IN ('waiting', 'queued')) - (OLD.state IN ('waiting', 'queued'))),
        points_running   = points_running + share.points * ((NEW.state = 'leased') - (OLD.state = 'leased')),
        points_done      = points_done + share.points * ((NEW.state = 'done') - (OLD.state = 'done')),
        points_failed    = points_failed + share.points
                           * ((NEW.state IN ('failed', 'dead')) - (OLD.state IN ('failed', 'dead'))),
        points_cancelled = points_cancelled + share.points
                           * ((NEW.state = 'cancelled') - (OLD.state = 'cancelled')),
        finished         = CASE
            WHEN points_queued + points_running + share.points
                 * ((NEW.state IN ('waiting', 'queued', 'leased')) - (OLD.state IN ('waiting', 'queued', 'leased'))) > 0
            THEN NULL
            ELSE coalesce(finished, NEW.changed)
        END
    FROM (SELECT sweep_id, count(*) AS points FROM point WHERE work_key = NEW.key GROUP BY sweep_id) AS share
    WHERE sweep.id = share.sweep_id;

    INSERT INTO event (sweep_id, seq, kind, work_key, at)
    SELECT id, version, NEW.state, NEW.key, NEW.changed FROM sweep
    WHERE id IN (SELECT sweep_id FROM point WHERE work_key = NEW.key);
END;
