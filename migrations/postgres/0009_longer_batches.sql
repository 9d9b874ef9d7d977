-- A batch of changes costs much the same whether it is a dozen or two: where so many come while one is applied, the next waits longer for
-- more. With 200 workers on two cores a few hundredths more points are finished, and results wait no longer for their answer.

-- As in 0006_finish_and_claim.sql.
CREATE OR REPLACE FUNCTION apply_transitions_of_all() RETURNS boolean LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
DECLARE
    are_many      boolean := EXISTS (SELECT 1 FROM transition WHERE transaction >= (SELECT transaction FROM first_to_apply) OFFSET 3);
    are_very_many boolean := are_many
        AND EXISTS (SELECT 1 FROM transition WHERE transaction >= (SELECT transaction FROM first_to_apply) OFFSET 12);
BEGIN
    IF are_many THEN
        PERFORM pg_sleep(CASE WHEN are_very_many THEN 0.02 ELSE 0.01 END);
    END IF;
    PERFORM set_config('synchronous_commit', 'off', true);
    PERFORM apply_pending_transitions();
    RETURN are_many;
END
$$;
