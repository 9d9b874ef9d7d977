//! PostgreSQL: a team's engine, for many machines.

use std::time::Duration;

use futures::future::BoxFuture;
use sqlx::pool::PoolConnection;
use sqlx::postgres::{PgConnectOptions, PgConnection, PgPool, PgPoolOptions, PgRow};
use sqlx::{AssertSqlSafe, Connection as _, Executor as _, Postgres};

use crate::connection::Role;
use crate::database::Database;
use crate::error::Result;
use crate::migration;

/// How long a statement waits for a lock, and an idle transaction keeps its own: a machine that is cut off in the middle of one
/// holds nobody up for longer.
const LOCK_TIMEOUT: &str = "30s";

/// How long a new connection may take.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(30);

/// How long a connection is trusted after its last use; later it is asked first whether it is still there, which takes a message and its
/// answer.
const TRUSTED_FOR: Duration = Duration::from_secs(1);

/// Takes the writers' advisory lock exclusively; the schema's triggers use the same arbitrary key.
const ALONE: &str = "SELECT pg_advisory_xact_lock(7237963465534699365)";

/// Takes the same lock shared.
const BESIDE_OTHERS: &str = "SELECT pg_advisory_xact_lock_shared(7237963465534699365)";

/// Goes through the turnstile (migrations/postgres/0002_queues.sql), after the writers' lock was taken.
const TURNSTILE: &str = "LOCK TABLE turnstile IN EXCLUSIVE MODE";

/// Connects to a server and brings the schema up to date. Any number of processes may do so at once.
pub(crate) async fn open(options: &PgConnectOptions, role: Role, clock_offset_ms: i64) -> Result<Database> {
    let mut options = options.clone().application_name("drillsweep").options([
        ("lock_timeout", LOCK_TIMEOUT),
        ("idle_in_transaction_session_timeout", LOCK_TIMEOUT),
        ("default_transaction_isolation", "read committed"),
        // No statement is worth compiling: where statistics are missing, the planner thinks that some are.
        ("jit", "off"),
        // Migrations tell of what is there already.
        ("client_min_messages", "warning"),
    ]);
    if let Role::Worker = role {
        // What a crash of the database forgets is computed again. All that workers do to one sweep goes through its row, one after the
        // other: each would wait for the disk.
        // Their statements look for a few rows by an index: planning one takes longer than running it.
        options = options.options([
            ("synchronous_commit", "off"),
            ("plan_cache_mode", "force_generic_plan"),
            ("enable_seqscan", "off"),
        ]);
    }
    // One of them listens for notifications.
    let connections = match role {
        Role::Server => 16,
        Role::Worker => 3,
    };
    let pool = PgPoolOptions::new()
        .max_connections(connections)
        .acquire_timeout(CONNECT_TIMEOUT)
        .test_before_acquire(false)
        .before_acquire(|connection, use_of_it| {
            Box::pin(async move {
                if use_of_it.idle_for > TRUSTED_FOR {
                    connection.ping().await?;
                }
                Ok(true)
            })
        })
        .after_connect(move |connection, _| {
            Box::pin(async move {
                if clock_offset_ms != 0 {
                    // On this connection the name stands for this view, before the schema's, which need not be there yet.
                    let clock = format!(
                        "CREATE TEMP VIEW clock AS SELECT
                         floor(extract(epoch FROM statement_timestamp()) * 1000)::bigint + {clock_offset_ms} AS now"
                    );
                    connection.execute(AssertSqlSafe(clock)).await?;
                }
                Ok(())
            })
        })
        .connect_with(options)
        .await?;
    if !migration::is_current(&pool).await? {
        migration::postgres().run(&pool).await?;
    }
    Ok(Database::Postgres(pool))
}

/// Connects to a server to look at what it has: nothing of it is made or changed.
pub(crate) async fn open_read_only(options: &PgConnectOptions) -> Result<Database> {
    let options = options.clone().application_name("drillsweep").options([
        ("default_transaction_read_only", "on"),
        // It locks nothing that others want. Who carries the store away keeps its snapshot while objects are copied.
        ("idle_in_transaction_session_timeout", "0"),
    ]);
    let pool = PgPoolOptions::new()
        .max_connections(1)
        .acquire_timeout(CONNECT_TIMEOUT)
        .connect_with(options)
        .await?;
    Ok(Database::Postgres(pool))
}

/// A transaction. Where it ends neither by a commit nor by being rolled back, its connection is closed, by which the server undoes it.
pub(crate) struct PostgresTransaction {
    connection: PoolConnection<Postgres>,
    has_ended: bool,
}

impl PostgresTransaction {
    /// One that sees one state of the database and changes nothing.
    pub(crate) async fn read(pool: &PgPool) -> Result<Self> {
        Self::begin(pool, "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY".to_owned()).await
    }

    /// One that holds the writers' lock exclusively. Deferred triggers run at once, since its later statements rely on what they do.
    pub(crate) async fn alone(pool: &PgPool) -> Result<Self> {
        Self::begin(pool, format!("BEGIN; SET CONSTRAINTS ALL IMMEDIATE; {ALONE}")).await
    }

    /// One that holds the writers' lock shared, as the schema's triggers do for statements outside one. Deferred triggers run at the
    /// commit.
    pub(crate) async fn beside_others(pool: &PgPool) -> Result<Self> {
        Self::begin(pool, format!("BEGIN; {BESIDE_OTHERS}")).await
    }

    async fn begin(pool: &PgPool, statements: String) -> Result<Self> {
        let mut begun = Self { connection: pool.acquire().await?, has_ended: false };
        begun.connection.execute(sqlx::raw_sql(AssertSqlSafe(statements))).await?;
        Ok(begun)
    }

    pub(crate) fn connection(&mut self) -> &mut PgConnection {
        &mut self.connection
    }

    pub(crate) async fn commit(self) -> Result<()> {
        self.end("COMMIT".to_owned()).await
    }

    /// Goes through the turnstile and commits: one message, so that nobody waits there for this client.
    pub(crate) async fn commit_in_turn(self) -> Result<()> {
        self.end(format!("{TURNSTILE}; COMMIT")).await
    }

    pub(crate) async fn rollback(self) -> Result<()> {
        self.end("ROLLBACK".to_owned()).await
    }

    async fn end(mut self, statements: String) -> Result<()> {
        self.connection.execute(sqlx::raw_sql(AssertSqlSafe(statements))).await?;
        self.has_ended = true;
        Ok(())
    }
}

impl Drop for PostgresTransaction {
    fn drop(&mut self) {
        if !self.has_ended {
            self.connection.close_on_drop();
        }
    }
}

/// Runs one statement as a transaction that holds the writers' lock shared: one message. Its rows have their values as text.
pub(crate) async fn beside_others(pool: &PgPool, statement: &str) -> Result<Vec<PgRow>> {
    script(pool, format!("{BESIDE_OTHERS}; {statement}")).await
}

/// The same of one that goes through the turnstile first; nobody waits there for this client.
pub(crate) async fn in_turn(pool: &PgPool, statement: &str) -> Result<Vec<PgRow>> {
    script(pool, format!("{BESIDE_OTHERS}; {TURNSTILE}; {statement}")).await
}

/// Statements in one message are one transaction. The first takes a lock.
fn script(pool: &PgPool, statements: String) -> BoxFuture<'_, Result<Vec<PgRow>>> {
    Box::pin(async move {
        let rows = sqlx::raw_sql(AssertSqlSafe(statements)).fetch_all(pool).await?;
        // The first row is what taking the lock gave.
        Ok(rows.into_iter().skip(1).collect())
    })
}
