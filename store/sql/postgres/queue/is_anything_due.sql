-- Whether a lease has run out, a retry is due, or one of them ends later than it could, had it begun now: then the clock
-- was set back.
-- $1 longest wait of a retry [ms].
SELECT EXISTS (SELECT 1 FROM work WHERE state = 'leased' AND lease_until < (SELECT now FROM clock))
    OR EXISTS (SELECT 1 FROM work WHERE state = 'leased' AND lease_until > (SELECT now FROM clock) + lease_ms)
    OR EXISTS (SELECT 1 FROM work
               WHERE state = 'waiting'
                 AND (ready_at <= (SELECT now FROM clock) OR ready_at > (SELECT now FROM clock) + $1))
