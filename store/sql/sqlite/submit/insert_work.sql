-- Stores work items, each a place after the one before.
-- ?1 their keys, hexadecimal digits, and changes: a JSON array of pairs; ?2 the place before the first, ?3 distance of the
-- places, ?4 base, ?5 version of the numbers, ?6 owner, ?7 whether they are held, ?8 priority, ?9 time, ?10 whether those
-- that are final are recomputed, ?11 first place that is taken in the owner's order.
--
-- What becomes of work that is there: what was cancelled, has a damaged result, or is to be recomputed, is taken up again as if it were new.
-- What is open goes as early as the most urgent sweep that wants it, is neither cancelled nor held any more, and becomes a
-- turn of the owner in whose order it stands nearer to the front: else a few points would wait for all of somebody else's
-- sweep that has them too. All else stays as it is, by the last condition: where a row is changed and is not open, it is
-- taken up again.
INSERT INTO work (key, changes, vtime, base, physics_version, owner, state, held, priority, ready_at, created, changed)
SELECT unhex(value ->> 0), value ->> 1, ?2 + ?3 * (key + 1), ?4, ?5, ?6, 'queued', ?7, ?8, ?9, ?9, ?9
FROM json_each(?1)
WHERE true
ON CONFLICT (key) DO UPDATE SET
    state = CASE WHEN is_open THEN state ELSE 'queued' END,
    changed = CASE WHEN is_open THEN changed ELSE excluded.changed END,
    owner = CASE WHEN is_open AND NOT (
                     state <> 'leased' AND owner <> excluded.owner AND held >= excluded.held
                     AND vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = work.owner AND o.is_open)
                         > excluded.vtime - ?11)
                 THEN owner ELSE excluded.owner END,
    vtime = CASE WHEN is_open AND NOT (
                     state <> 'leased' AND owner <> excluded.owner AND held >= excluded.held
                     AND vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = work.owner AND o.is_open)
                         > excluded.vtime - ?11)
                 THEN vtime ELSE excluded.vtime END,
    error = CASE WHEN is_open THEN error END,
    progress = CASE WHEN is_open THEN progress ELSE 0 END,
    checkpoint = CASE WHEN is_open OR NOT ?10 THEN checkpoint END,
    crash_count = CASE WHEN is_open THEN crash_count ELSE 0 END,
    failure_count = CASE WHEN is_open THEN failure_count ELSE 0 END,
    priority = CASE WHEN is_open THEN max(priority, excluded.priority) ELSE excluded.priority END,
    cancel_requested = 0,
    held = CASE WHEN is_open THEN held AND excluded.held ELSE excluded.held END
WHERE CASE WHEN is_open
           THEN cancel_requested <> 0 OR held > excluded.held OR priority < excluded.priority
                OR (state <> 'leased' AND owner <> excluded.owner AND held >= excluded.held
                    AND vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = work.owner AND o.is_open)
                        > excluded.vtime - ?11)
           ELSE state = 'cancelled' OR ?10
                OR EXISTS (SELECT 1 FROM result WHERE work_key = work.key AND damaged IS NOT NULL)
      END
