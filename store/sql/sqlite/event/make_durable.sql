-- Nothing: what one process sees, a crash of another one does not undo.
SELECT 1 WHERE false
