-- What was asked (sweep, point), what must be computed (work, by content hash), what came of it (result, artifact).
-- Times are integer milliseconds since the epoch, from the database's clock.

CREATE TABLE sweep (
    id         TEXT    NOT NULL PRIMARY KEY,
    name       TEXT,
    owner      TEXT    NOT NULL,
    request    TEXT    NOT NULL,
    priority   INTEGER NOT NULL DEFAULT 0,
    total      INTEGER NOT NULL,
    version    INTEGER NOT NULL DEFAULT 1,
    cancelled  INTEGER NOT NULL DEFAULT 0,
    created    INTEGER NOT NULL,
    finished   INTEGER
) STRICT;

CREATE INDEX sweep_by_owner ON sweep (owner, id);

CREATE TABLE work (
    key              BLOB    NOT NULL PRIMARY KEY,
    physics_version  INTEGER NOT NULL,
    scenario         TEXT    NOT NULL,
    owner            TEXT    NOT NULL,
    state            TEXT    NOT NULL CHECK (state IN ('waiting', 'queued', 'leased', 'done', 'failed', 'dead', 'cancelled')),
    priority         INTEGER NOT NULL,
    vtime            INTEGER NOT NULL,
    ready_at         INTEGER NOT NULL,
    attempt          INTEGER NOT NULL DEFAULT 0,
    starts           INTEGER NOT NULL DEFAULT 0,
    crash_count      INTEGER NOT NULL DEFAULT 0,
    failure_count    INTEGER NOT NULL DEFAULT 0,
    lease_owner      TEXT,
    lease_until      INTEGER,
    cancel_requested INTEGER NOT NULL DEFAULT 0,
    progress         REAL    NOT NULL DEFAULT 0,
    error            TEXT,
    created          INTEGER NOT NULL,
    started          INTEGER,
    finished         INTEGER
) STRICT;

-- Only claimable rows: the index stays small however many points are finished.
CREATE INDEX work_ready ON work (physics_version, priority DESC, vtime, key) WHERE state = 'queued';
CREATE INDEX work_leased ON work (lease_until) WHERE state = 'leased';
CREATE INDEX work_waiting ON work (ready_at) WHERE state = 'waiting';

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
    seq      INTEGER NOT NULL,
    kind     TEXT    NOT NULL,
    work_key BLOB,
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

CREATE TABLE owner_clock (
    owner TEXT    NOT NULL PRIMARY KEY,
    vtime INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE worker (
    id              TEXT    NOT NULL PRIMARY KEY,
    host            TEXT    NOT NULL,
    process         INTEGER NOT NULL,
    version         TEXT    NOT NULL,
    physics_version INTEGER NOT NULL,
    started         INTEGER NOT NULL,
    last_seen       INTEGER NOT NULL
) STRICT;
