//! PostgreSQL: a team's engine, for many machines.

use std::time::Duration;

use sqlx::postgres::{PgConnectOptions, PgPool, PgPoolOptions};
use sqlx::{AssertSqlSafe, Executor as _};

use crate::connection::Role;
use crate::database::{Database, Transaction};
use crate::error::Result;
use crate::migration;

/// How long a statement waits for a lock, and an idle transaction keeps its own: a machine that is cut off in the middle of one
/// holds nobody up for longer.
const LOCK_TIMEOUT: &str = "30s";

/// How long a new connection may take.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(30);

/// Takes the writers' advisory lock exclusively; the schema's triggers use the same arbitrary key. Deferred triggers run at once in such a
/// transaction, since its later statements rely on what they do.
const ALONE: &str = "SET CONSTRAINTS ALL IMMEDIATE; SELECT pg_advisory_xact_lock(7237963465534699365)";

/// Takes the same lock shared; deferred triggers run at the commit.
const BESIDE_OTHERS: &str = "SELECT pg_advisory_xact_lock_shared(7237963465534699365)";

/// Connects to a server and brings the schema up to date. Any number of processes may do so at once.
pub(crate) async fn open(options: &PgConnectOptions, role: Role, clock_offset_ms: i64) -> Result<Database> {
    let mut options = options.clone().application_name("drillsweep").options([
        ("lock_timeout", LOCK_TIMEOUT),
        ("idle_in_transaction_session_timeout", LOCK_TIMEOUT),
        ("default_transaction_isolation", "read committed"),
        // Migrations tell of what is there already.
        ("client_min_messages", "warning"),
    ]);
    if let Role::Worker = role {
        // What a crash of the database forgets is computed again. All that workers do to one sweep goes through its row, one after the
        // other: each would wait for the disk.
        options = options.options([("synchronous_commit", "off")]);
    }
    // One of them listens for notifications.
    let connections = match role {
        Role::Server => 16,
        Role::Worker => 3,
    };
    let pool = PgPoolOptions::new()
        .max_connections(connections)
        .acquire_timeout(CONNECT_TIMEOUT)
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
    let options =
        options.clone().application_name("drillsweep").options([("default_transaction_read_only", "on")]);
    let pool = PgPoolOptions::new()
        .max_connections(1)
        .acquire_timeout(CONNECT_TIMEOUT)
        .connect_with(options)
        .await?;
    Ok(Database::Postgres(pool))
}

/// A transaction that holds the writers' lock exclusively.
pub(crate) async fn write_alone(pool: &PgPool) -> Result<Transaction> {
    write(pool, ALONE).await
}

/// A transaction that holds the writers' lock shared, as the schema's triggers do for statements outside one.
pub(crate) async fn write_beside_others(pool: &PgPool) -> Result<Transaction> {
    write(pool, BESIDE_OTHERS).await
}

async fn write(pool: &PgPool, lock: &'static str) -> Result<Transaction> {
    let mut transaction = pool.begin_with("BEGIN").await?;
    transaction.execute(sqlx::raw_sql(lock)).await?;
    Ok(Transaction::Postgres(transaction))
}
