-- The requests by which points were added, a row each: in the row of the sweep, which is written with every change of one of its
-- points, they made each of these writes as long as all of them.
CREATE TABLE appended (
    sweep_id TEXT    NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    number   INTEGER NOT NULL,
    request  TEXT    NOT NULL,
    PRIMARY KEY (sweep_id, number)
) STRICT, WITHOUT ROWID;

INSERT INTO appended (sweep_id, number, request)
SELECT sweep.id, entry.key + 1, entry.value FROM sweep, json_each(sweep.appended) AS entry;

ALTER TABLE sweep DROP COLUMN appended;
