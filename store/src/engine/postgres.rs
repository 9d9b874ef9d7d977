//! PostgreSQL: a team's engine, for many machines.
//!
//! Writers that change the state of work items only record the changes; consequences for sweeps and points are applied in batches
//! (migrations/postgres/0001_schema.sql). After its commit each writer calls `apply_transitions`, which returns at once if another process
//! applies changes at that moment; that process repeats until nothing is pending. All changes are therefore applied once all their writers
//! have returned. The procedure `finish_and_claim` does the same after its commit. Readers of consequences call it from time to time, too,
//! since a process may have died in between.

use sqlx::postgres::{PgConnectOptions, PgConnection, PgPoolOptions};
use sqlx::{AssertSqlSafe, Connection as _, Executor as _};

use crate::engine::connections::{CONNECT_TIMEOUT, Connections, Lent, TRUSTED_FOR};
use crate::engine::migration;
use crate::engine::role::Role;
use crate::error::{Result, not_connected};

/// Time for which a statement waits for a lock, and an idle transaction keeps its own: a machine that is cut off within a transaction
/// blocks others for no longer.
const LOCK_TIMEOUT: &str = "30s";

/// Takes the writers' advisory lock shared; the schema's functions use the same arbitrary key.
const BESIDE_OTHERS: &str = "SELECT pg_advisory_xact_lock_shared(7237963465534699365)";

/// Begins a transaction that sees one state of the database and changes nothing.
const READ: &str = "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY";

/// Applies pending changes, unless another process does; true if it has applied them.
const APPLY: &str = "SELECT apply_transitions()";

/// Connects to a server and brings the schema up to date. Any number of processes may do so at once.
pub(crate) async fn open(
    options: &PgConnectOptions,
    role: Role,
    clock_offset_ms: i64,
) -> Result<Connections> {
    let mut options = options.clone().application_name("drillsweep").options([
        ("lock_timeout", LOCK_TIMEOUT),
        ("idle_in_transaction_session_timeout", LOCK_TIMEOUT),
        ("default_transaction_isolation", "read committed"),
        // No statement is worth compiling: if statistics are missing, the planner thinks that some are.
        ("jit", "off"),
        // Migrations report existing objects as notices.
        ("client_min_messages", "warning"),
    ]);
    if let Role::Worker = role {
        // Results that a crash of the database loses are computed again.
        // Their statements look for a few rows by an index: planning one takes longer than running it.
        options = options.options([
            ("synchronous_commit", "off"),
            ("plan_cache_mode", "force_generic_plan"),
            ("enable_seqscan", "off"),
        ]);
    }
    // One of them listens for notifications, and one is kept in addition to the pool.
    let connections = match role {
        Role::Server => 16,
        Role::Worker => 3,
    };
    let pool = PgPoolOptions::new()
        .max_connections(connections - 1)
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
        .await
        .map_err(not_connected)?;
    if !migration::is_current(&pool).await? {
        migration::postgres().run(&pool).await?;
    }
    Ok(Connections::new(pool))
}

/// Connects to a server read-only: nothing is made or changed.
pub(crate) async fn open_read_only(options: &PgConnectOptions) -> Result<Connections> {
    let options = options.clone().application_name("drillsweep").options([
        ("default_transaction_read_only", "on"),
        // It locks nothing that others want. Who carries the store away keeps its snapshot while objects are copied.
        ("idle_in_transaction_session_timeout", "0"),
    ]);
    let pool = PgPoolOptions::new()
        .max_connections(1)
        .acquire_timeout(CONNECT_TIMEOUT)
        .connect_with(options)
        .await
        .map_err(not_connected)?;
    Ok(Connections::new(pool))
}

/// A transaction. If it ends neither by a commit nor by being rolled back, its connection is closed, by which the server undoes it.
pub(crate) struct PostgresTransaction {
    connection: Lent,
}

impl PostgresTransaction {
    /// One that sees one state of the database and changes nothing.
    pub(crate) async fn read(connections: &Connections) -> Result<Self> {
        Self::begin(connections, READ.to_owned()).await
    }

    /// The same, in a state without pending changes. They are applied first, if the schema has them, although the connection may be
    /// read-only by default.
    pub(crate) async fn read_applied(connections: &Connections) -> Result<Self> {
        let mut begun = Self { connection: connections.lend().await? };
        let is_known: bool = sqlx::query_scalar("SELECT to_regproc('apply_pending_transitions') IS NOT NULL")
            .fetch_one(begun.connection())
            .await?;
        let mut statements = vec![READ];
        if is_known {
            // Nobody changes work between the two. The snapshot is that of the first statement.
            statements = vec![
                "SELECT pg_advisory_lock(7237963465534699365)",
                "BEGIN READ WRITE",
                "SELECT apply_pending_transitions()",
                "COMMIT",
                READ,
                "SELECT pg_advisory_unlock(7237963465534699365)",
            ];
        }
        for statement in statements {
            begun.connection.execute(statement).await?;
        }
        Ok(begun)
    }

    /// A transaction that holds the writers' lock exclusively. Consequences of its changes are applied with each of its statements.
    pub(crate) async fn alone(connections: &Connections) -> Result<Self> {
        Self::begin(connections, "BEGIN; SELECT write_alone()".to_owned()).await
    }

    /// One that holds the writers' lock shared, as the schema's triggers do for statements outside one.
    pub(crate) async fn beside_others(connections: &Connections) -> Result<Self> {
        Self::begin(connections, format!("BEGIN; {BESIDE_OTHERS}")).await
    }

    async fn begin(connections: &Connections, statements: String) -> Result<Self> {
        let mut begun = Self { connection: connections.lend().await? };
        begun.connection.execute(sqlx::raw_sql(AssertSqlSafe(statements))).await?;
        Ok(begun)
    }

    pub(crate) fn connection(&mut self) -> &mut PgConnection {
        &mut self.connection
    }

    pub(crate) async fn commit(self) -> Result<()> {
        self.end("COMMIT".to_owned()).await
    }

    /// The same, without waiting for the disk. The log is written in its order, so that it is durable with any later commit that is.
    pub(crate) async fn commit_for_now(self) -> Result<()> {
        self.end("SET LOCAL synchronous_commit = off; COMMIT".to_owned()).await
    }

    pub(crate) async fn rollback(self) -> Result<()> {
        self.end("ROLLBACK".to_owned()).await
    }

    async fn end(mut self, statements: String) -> Result<()> {
        self.connection.execute(sqlx::raw_sql(AssertSqlSafe(statements))).await?;
        self.connection.give_back();
        Ok(())
    }
}

/// Applies pending changes until none is left or another process applies them. If that fails, the changes remain committed, and the next
/// caller applies their consequences.
pub(crate) async fn apply_transitions(connections: &Connections) {
    if let Err(error) = apply_all(connections).await {
        tracing::warn!(%error, "pending changes of points are left to other processes");
    }
}

async fn apply_all(connections: &Connections) -> sqlx::Result<()> {
    let mut lent = connections.lend().await?;
    while sqlx::query_scalar(APPLY).fetch_one(&mut *lent).await? {}
    lent.give_back();
    Ok(())
}
