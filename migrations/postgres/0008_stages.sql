-- What follows from a work item's state is set by one trigger, before its row is written. Columns that are generated and a condition of the
-- table are parsed anew for each statement, and a trigger after the change reads both rows again.
ALTER TABLE work
    ALTER COLUMN stage DROP EXPRESSION,
    ALTER COLUMN stage SET DEFAULT 'queued',
    ALTER COLUMN is_open DROP EXPRESSION,
    ALTER COLUMN is_open SET DEFAULT true,
    ALTER COLUMN stage_of_cancelled DROP EXPRESSION,
    ALTER COLUMN stage_of_cancelled SET DEFAULT 'cancelled',
    DROP CONSTRAINT work_state_check;

DROP TRIGGER work_has_changed ON work;
DROP FUNCTION work_has_changed;

CREATE FUNCTION follow_state() RETURNS trigger LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    -- As 0001_schema.sql says of the columns.
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
