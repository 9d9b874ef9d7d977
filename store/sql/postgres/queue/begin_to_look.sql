-- Whether it is time that somebody looks for what is due, who then is the one that asks (migrations/postgres/0001_schema.sql).
-- $1 how long nobody need look after somebody has [ms].
SELECT begin_to_look($1)
