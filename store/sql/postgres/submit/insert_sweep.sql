-- Stores a sweep, hidden until it is shown (`show`); its counts follow (`count`).
-- $1 sweep, $2 name, $3 owner, $4 request, $5 priority, $6 number of points, $7 time, $8 tags, $9 whether it wants its
-- points recomputed.
INSERT INTO sweep (id, name, owner, request, priority, points, created, tags, refreshes, hidden)
VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $7)
