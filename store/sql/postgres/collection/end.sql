-- Notes that a collection has ended.
-- $1 what it deleted, JSON.
UPDATE collection SET ended = (SELECT now FROM clock), deleted = $1 WHERE id = 1
