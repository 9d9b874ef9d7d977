-- Stores work items, each a place after the one before.
-- $1 their keys, hexadecimal digits, and changes: a JSON array of pairs; $2 the place before the first, $3 distance of the
-- places, $4 base, $5 version of the numbers, $6 owner, $7 whether they are held, $8 priority, $9 time, $10 whether those
-- that are final are recomputed, $11 first place that is taken in the owner's order.
--
-- What becomes of work that is there: what was cancelled, has a damaged result, or is to be recomputed, is taken up again as if it were new.
-- What is open goes as early as the most urgent sweep that wants it, is neither cancelled nor held any more, and becomes a
-- turn of the owner in whose order it stands nearer to the front: else a few points would wait for all of somebody else's
-- sweep that has them too. All else stays as it is, by the last condition: where a row is changed and is not open, it is
-- taken up again.
--
-- A work item that is among them twice is stored as the first of the two: a statement can change a row only once.
INSERT INTO work AS w (key, changes, vtime, base, physics_version, owner, state, held, priority, ready_at, created, changed)
SELECT DISTINCT ON (key) key, changes, $2 + $3 * number, $4, $5, $6, 'queued', $7, $8, $9, $9, $9
FROM (SELECT decode(value ->> 0, 'hex') AS key, value ->> 1 AS changes, number
      FROM json_array_elements($1::json) WITH ORDINALITY AS rows (value, number)) AS new
ORDER BY key, number
ON CONFLICT (key) DO UPDATE SET
    state = CASE WHEN w.is_open THEN w.state ELSE 'queued' END,
    changed = CASE WHEN w.is_open THEN w.changed ELSE excluded.changed END,
    owner = CASE WHEN w.is_open AND NOT (
                     w.state <> 'leased' AND w.owner <> excluded.owner AND w.held >= excluded.held
                     AND w.vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = w.owner AND o.is_open)
                         > excluded.vtime - $11)
                 THEN w.owner ELSE excluded.owner END,
    vtime = CASE WHEN w.is_open AND NOT (
                     w.state <> 'leased' AND w.owner <> excluded.owner AND w.held >= excluded.held
                     AND w.vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = w.owner AND o.is_open)
                         > excluded.vtime - $11)
                 THEN w.vtime ELSE excluded.vtime END,
    error = CASE WHEN w.is_open THEN w.error END,
    progress = CASE WHEN w.is_open THEN w.progress ELSE 0 END,
    checkpoint = CASE WHEN w.is_open OR NOT $10 THEN w.checkpoint END,
    crash_count = CASE WHEN w.is_open THEN w.crash_count ELSE 0 END,
    failure_count = CASE WHEN w.is_open THEN w.failure_count ELSE 0 END,
    priority = CASE WHEN w.is_open THEN greatest(w.priority, excluded.priority) ELSE excluded.priority END,
    cancel_requested = false,
    held = CASE WHEN w.is_open THEN w.held AND excluded.held ELSE excluded.held END
WHERE CASE WHEN w.is_open
           THEN w.cancel_requested OR w.held > excluded.held OR w.priority < excluded.priority
                OR (
                     w.state <> 'leased' AND w.owner <> excluded.owner AND w.held >= excluded.held
                     AND w.vtime - (SELECT min(o.vtime) FROM work o WHERE o.owner = w.owner AND o.is_open)
                         > excluded.vtime - $11)
           ELSE w.state = 'cancelled' OR $10
                OR EXISTS (SELECT 1 FROM result WHERE work_key = w.key AND damaged IS NOT NULL)
      END
