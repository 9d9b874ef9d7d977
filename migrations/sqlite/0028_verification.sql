-- Reference runs that verify points of a sweep stand beside its points: cancelling, pausing, retrying, priority and retention go by
-- the work behind a row, and hold for both. Counts and listings tell them apart by `verifies`.

DROP TRIGGER work_changes_state;

CREATE TABLE point_or_verification (
    sweep_id   TEXT    NOT NULL REFERENCES sweep (id) ON DELETE CASCADE,
    -- 0: the point with this ordinal. 1: the reference run that verifies that point.
    verifies   INTEGER NOT NULL CHECK (verifies IN (0, 1)),
    ordinal    INTEGER NOT NULL,
    parameters TEXT    NOT NULL,
    work_key   BLOB    NOT NULL REFERENCES work (key),
    PRIMARY KEY (sweep_id, verifies, ordinal)
) STRICT, WITHOUT ROWID;

INSERT INTO point_or_verification (sweep_id, verifies, ordinal, parameters, work_key)
SELECT sweep_id, 0, ordinal, parameters, work_key FROM point;

DROP TABLE point;
ALTER TABLE point_or_verification RENAME TO point;
CREATE INDEX point_by_work ON point (work_key);

-- Reference runs by the state of their work, kept by the trigger below as the points' counts are.
ALTER TABLE sweep ADD COLUMN verifications           INTEGER NOT NULL DEFAULT 0;
ALTER TABLE sweep ADD COLUMN verifications_queued    INTEGER NOT NULL DEFAULT 0;
ALTER TABLE sweep ADD COLUMN verifications_running   INTEGER NOT NULL DEFAULT 0;
ALTER TABLE sweep ADD COLUMN verifications_done      INTEGER NOT NULL DEFAULT 0;
ALTER TABLE sweep ADD COLUMN verifications_failed    INTEGER NOT NULL DEFAULT 0;
ALTER TABLE sweep ADD COLUMN verifications_cancelled INTEGER NOT NULL DEFAULT 0;

-- As before, for both kinds of rows: a sweep is finished when neither has an open one.
CREATE TRIGGER work_changes_state AFTER UPDATE OF state ON work WHEN NEW.state <> OLD.state
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
         (SELECT (NEW.state IN ('waiting', 'queued')) - (OLD.state IN ('waiting', 'queued')) AS queued,
                 (NEW.state = 'leased') - (OLD.state = 'leased')                             AS running,
                 (NEW.state = 'done') - (OLD.state = 'done')                                 AS done,
                 (NEW.state IN ('failed', 'dead')) - (OLD.state IN ('failed', 'dead'))       AS failed,
                 (NEW.state = 'cancelled') - (OLD.state = 'cancelled')                       AS cancelled) AS step
    WHERE sweep.id = share.sweep_id;

    INSERT INTO event (sweep_id, seq, kind, work_key, at)
    SELECT id, version, NEW.state, NEW.key, NEW.changed FROM sweep
    WHERE id IN (SELECT sweep_id FROM point WHERE work_key = NEW.key);
END;
