-- A worker that goes on sends one message between two points instead of four.

-- The writers' lock is nearly always free, and then asking for it is no statement of its own.
CREATE OR REPLACE FUNCTION share_the_writers_lock() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF NOT pg_try_advisory_xact_lock_shared(7237963465534699365) THEN
        PERFORM pg_advisory_xact_lock_shared(7237963465534699365);
    END IF;
    RETURN NULL;
END
$$;

-- As in 0004_transitions.sql.
CREATE OR REPLACE FUNCTION finish_work(
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

-- Whether there are transitions that have not been applied.
CREATE FUNCTION transitions_are_pending() RETURNS boolean LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    RETURN EXISTS (SELECT 1 FROM transition WHERE transaction >= (SELECT transaction FROM first_to_apply));
END
$$;

-- Applies what is pending, as `apply_transitions` does; whoever calls it has the lock of those who apply. Gives whether many were at work.
CREATE FUNCTION apply_transitions_of_all() RETURNS boolean LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
DECLARE
    are_many boolean := EXISTS (SELECT 1 FROM transition WHERE transaction >= (SELECT transaction FROM first_to_apply) OFFSET 3);
BEGIN
    IF are_many THEN
        PERFORM pg_sleep(0.01);
    END IF;
    PERFORM set_config('synchronous_commit', 'off', true);
    PERFORM apply_pending_transitions();
    RETURN are_many;
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
