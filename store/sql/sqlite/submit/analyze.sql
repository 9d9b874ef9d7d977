-- Nothing: the plans are the same however much there is.
SELECT 1 WHERE false
