-- Size of all artifacts, those that share a blob counted each time.
SELECT coalesce(sum(bytes), 0)::bigint FROM artifact
