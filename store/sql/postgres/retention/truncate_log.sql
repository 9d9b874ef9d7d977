-- Nothing: the server keeps its write-ahead log, and its vacuum gives pages back.
SELECT 1 WHERE false
