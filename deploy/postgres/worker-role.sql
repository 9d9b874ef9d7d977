-- A role for workers, who need less than the server: they claim, renew and finish work, and read scenarios. They cannot read tokens,
-- nor make, change or delete sweeps.
--
--   psql --dbname=drillsweep --set=role=drillsweep_worker --file=worker-role.sql
--   psql --dbname=drillsweep --command="CREATE USER rig7 PASSWORD '...' IN ROLE drillsweep_worker"
--
-- Run it as the owner of the tables, after the server has made them, and again after each new version of the server. It may be run any
-- number of times.
\set ON_ERROR_STOP on
SELECT format('CREATE ROLE %I NOLOGIN', :'role')
WHERE NOT EXISTS (SELECT 1 FROM pg_roles WHERE rolname = :'role') \gexec

REVOKE ALL ON ALL TABLES IN SCHEMA public FROM :"role";

GRANT SELECT ON _sqlx_migrations, clock, scenario, work, owner_turn, queue_start, result, artifact, upload, removal, worker TO :"role";
GRANT UPDATE (state, fencing_token, attempts, progress, worker_note, lease_owner, lease_until, lease_ms, changed, error,
              checkpoint, crash_count, failure_count, ready_at) ON work TO :"role";
GRANT INSERT, DELETE, UPDATE (disagrees, provenance) ON result TO :"role";
GRANT INSERT ON artifact TO :"role";
GRANT INSERT, UPDATE ON upload TO :"role";
GRANT INSERT, UPDATE, DELETE ON worker TO :"role";
GRANT SELECT, INSERT, UPDATE ON machine_speed TO :"role";
