-- Writes a note to the write-ahead log. Once it is committed durably, so is all that was committed before, as what workers commit is not
-- at once.
SELECT 1 FROM pg_logical_emit_message(true, 'drillsweep', '')
