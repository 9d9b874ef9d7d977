-- Whoever claims looks once a second whether leases have run out or retries are due, and reads all leases for it. Of many processes one does
-- so for all.

-- One row: when somebody began to look last.
CREATE TABLE expiry_look (
    at BIGINT NOT NULL
);

INSERT INTO expiry_look (at) VALUES (0);

-- Whether somebody has to look, who then is the one that asked: not if one has begun to within the pause. By a clock that was set back it is
-- time to look.
CREATE FUNCTION begin_to_look(pause bigint) RETURNS boolean LANGUAGE plpgsql
SECURITY DEFINER SET search_path FROM CURRENT AS $$
BEGIN
    IF EXISTS (SELECT 1 FROM expiry_look CROSS JOIN clock WHERE at > now - pause AND at <= now) THEN
        RETURN false;
    END IF;
    PERFORM 1 FROM expiry_look FOR UPDATE SKIP LOCKED;
    IF NOT FOUND THEN
        RETURN false;
    END IF;
    UPDATE expiry_look SET at = now FROM clock;
    RETURN true;
END
$$;
