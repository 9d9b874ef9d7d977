-- A point costs less to store, to claim and to finish: its rows are in fewer indexes, and what they name is looked up once a statement.

-- Indexes that each claim, each result and each submitted point wrote. All open work is gone through by `work_open_by_owner`. What waits
-- for a version of the numbers is in `work_ready`, in `work_waiting`, or held.
DROP INDEX work_open;
DROP INDEX work_open_by_version;
CREATE INDEX work_held ON work (physics_version) WHERE state = 'queued' AND held;
-- Whether a base is in use the garbage collector asks once for all bases.
DROP INDEX work_by_base;

-- References that are checked once a statement instead of once a row. Points, bases and sweeps are stored and deleted by those who have them
-- to themselves, so that no row has to be locked for it; and events are told to sweeps that exist.
ALTER TABLE work DROP CONSTRAINT work_base_fkey;
ALTER TABLE point DROP CONSTRAINT point_work_key_fkey, DROP CONSTRAINT point_sweep_id_fkey;
ALTER TABLE event DROP CONSTRAINT event_sweep_id_fkey;

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
