-- Owners take turns (start-time fair queueing): the one whose virtual time is least is served, and pays for it. Within an
-- owner the most urgent goes first, then the order asked for: work.vtime is a place in that order.

CREATE TABLE owner_turn (
    owner TEXT    NOT NULL PRIMARY KEY,
    vtime INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

INSERT INTO owner_turn (owner, vtime) SELECT DISTINCT owner, 0 FROM work;

DROP INDEX work_ready;
CREATE INDEX work_ready ON work (physics_version, owner, priority DESC, vtime, key) WHERE state = 'queued' AND held = 0;

-- Idle time is not saved up: who comes back has missed all turns but the one before the latest.
CREATE TRIGGER work_takes_a_turn AFTER UPDATE OF state ON work WHEN NEW.state = 'leased' AND OLD.state <> 'leased'
BEGIN
    UPDATE owner_turn SET vtime = max(vtime, (SELECT max(vtime) FROM owner_turn) - 1000) + 1000
    WHERE owner = NEW.owner;
END;
