-- A result's blobs are reserved together, and with them its worker's lease is renewed: one message instead of one for each.

-- As `reserve_blob` (0004_transitions.sql), for all of a JSON array's. Gives those that are reserved.
CREATE FUNCTION reserve_blobs(names json, length_of_reservation bigint) RETURNS SETOF text LANGUAGE plpgsql AS $$
BEGIN
    IF NOT pg_try_advisory_xact_lock_shared(7237963465534699365) THEN
        PERFORM pg_advisory_xact_lock_shared(7237963465534699365);
    END IF;
    -- In one order, so that no two wait for each other.
    RETURN QUERY
    INSERT INTO upload (blob, expires)
    SELECT name, now + length_of_reservation FROM clock CROSS JOIN json_array_elements_text(names) AS wanted (name)
    WHERE NOT EXISTS (SELECT 1 FROM removal WHERE removal.blob = name AND expires > now)
    ORDER BY name
    ON CONFLICT (blob) DO UPDATE SET expires = greatest(upload.expires, excluded.expires)
    RETURNING blob;
END
$$;
