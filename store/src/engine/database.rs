//! The engine behind the store: a SQLite file, or a PostgreSQL server.
//!
//! SQLite has one writer at a time. PostgreSQL has many, of two kinds. What changes the state of one work item (a claim, a result, a
//! failure) runs concurrently with others of its kind, and its consequences for others (the turn of its owner, the sweeps that have it) is noted
//! with it and applied in batches (migrations/postgres/0001_schema.sql). All that changes several (submitting, cancelling, pausing,
//! collecting garbage) runs alone, as everything does on SQLite: it holds the writers' advisory lock exclusively, which the former hold
//! shared. Triggers take the shared lock and note the changes, so that no statement can forget them.
//!
//! Futures are boxed here for the reason that `query.rs` gives.

use futures::future::BoxFuture;
use sqlx::{SqlitePool, SqliteTransaction};
use tokio::sync::OwnedMutexGuard;

use crate::engine::connections::{ConnectionNumbers, Connections};
use crate::engine::location::DatabaseLocation;
use crate::engine::postgres::{self, PostgresTransaction};
use crate::engine::query::{Query, Record, Session};
use crate::engine::role::Role;
use crate::engine::sqlite::{self, Writers};
use crate::error::Result;

/// Connections to an engine. Cheap to clone.
#[derive(Debug, Clone)]
pub(crate) enum Database {
    /// A file, and the turn to write it.
    Sqlite(SqlitePool, Writers),
    /// A server.
    Postgres(Connections),
}

/// A transaction. It is undone unless it is committed.
pub(crate) enum Transaction {
    Sqlite {
        transaction: SqliteTransaction<'static>,
        /// Given up after the transaction: fields are dropped in their order.
        _turn: Option<OwnedMutexGuard<()>>,
    },
    Postgres(PostgresTransaction),
}

impl Database {
    /// Connects to it and brings its schema up to date. Any number of processes may do so at once.
    pub(crate) fn open(
        location: &DatabaseLocation,
        role: Role,
        clock_offset_ms: i64,
    ) -> BoxFuture<'_, Result<Self>> {
        Box::pin(async move {
            Ok(match location {
                DatabaseLocation::Sqlite(path) => {
                    Self::of_file(sqlite::open(path, role, clock_offset_ms).await?)
                }
                DatabaseLocation::Postgres(options) => {
                    Database::Postgres(postgres::open(options, role, clock_offset_ms).await?)
                }
            })
        })
    }

    /// Connects to it read-only: nothing is made or changed.
    pub(crate) fn open_read_only(location: &DatabaseLocation) -> BoxFuture<'_, Result<Self>> {
        Box::pin(async move {
            Ok(match location {
                DatabaseLocation::Sqlite(path) => Self::of_file(sqlite::open_read_only(path).await?),
                DatabaseLocation::Postgres(options) => {
                    Database::Postgres(postgres::open_read_only(options).await?)
                }
            })
        })
    }

    fn of_file(pool: SqlitePool) -> Self {
        Database::Sqlite(pool, Writers::default())
    }

    /// A transaction that sees one state of the database and changes nothing.
    pub(crate) fn read(&self) -> BoxFuture<'_, Result<Transaction>> {
        Box::pin(async move {
            Ok(match self {
                Database::Sqlite(pool, _) => {
                    Transaction::Sqlite { transaction: pool.begin_with("BEGIN").await?, _turn: None }
                }
                Database::Postgres(connections) => {
                    Transaction::Postgres(PostgresTransaction::read(connections).await?)
                }
            })
        })
    }

    /// The same, and in that state all is done that follows from changes of work items.
    pub(crate) fn read_applied(&self) -> BoxFuture<'_, Result<Transaction>> {
        Box::pin(async move {
            match self {
                Database::Sqlite(..) => self.read().await,
                Database::Postgres(connections) => {
                    Ok(Transaction::Postgres(PostgresTransaction::read_applied(connections).await?))
                }
            }
        })
    }

    /// A transaction during which no other one changes the state of a work item, a point or a sweep.
    pub(crate) fn write(&self) -> BoxFuture<'_, Result<Transaction>> {
        Box::pin(async move {
            match self {
                Database::Sqlite(pool, writers) => Transaction::of_file(pool, writers).await,
                Database::Postgres(connections) => {
                    Ok(Transaction::Postgres(PostgresTransaction::alone(connections).await?))
                }
            }
        })
    }

    /// A transaction that changes the state of one work item and what belongs to it, concurrently with others that do so.
    pub(crate) fn write_one(&self) -> BoxFuture<'_, Result<Transaction>> {
        Box::pin(async move {
            match self {
                Database::Sqlite(pool, writers) => Transaction::of_file(pool, writers).await,
                Database::Postgres(connections) => {
                    Ok(Transaction::Postgres(PostgresTransaction::beside_others(connections).await?))
                }
            }
        })
    }

    /// Applies the consequences of committed changes of work items for others, if they are not applied with the change. A process that has made
    /// such a change by a statement of its own calls it after that.
    pub(crate) fn apply_transitions(&self) -> BoxFuture<'_, ()> {
        Box::pin(async move {
            match self {
                Database::Sqlite(..) => {}
                Database::Postgres(connections) => postgres::apply_transitions(connections).await,
            }
        })
    }

    /// Connections at this time.
    pub(crate) fn connections(&self) -> ConnectionNumbers {
        match self {
            Database::Sqlite(pool, _) => {
                ConnectionNumbers { open: pool.size(), idle: pool.num_idle() as u32 }
            }
            Database::Postgres(connections) => connections.numbers(),
        }
    }

    /// Closes all connections.
    pub(crate) fn close(&self) -> BoxFuture<'_, ()> {
        Box::pin(async move {
            match self {
                Database::Sqlite(pool, _) => pool.close().await,
                Database::Postgres(connections) => connections.close().await,
            }
        })
    }
}

impl Query {
    /// Runs a statement that changes the state of a work item if it returns rows, and returns these; the consequences for sweeps are
    /// applied after it.
    pub(crate) async fn rows_of_change<T: Record>(self, database: &Database) -> Result<Vec<T>> {
        let rows = self.rows(database).await?;
        if !rows.is_empty() {
            database.apply_transitions().await;
        }
        Ok(rows)
    }

    /// Runs a statement that changes the state of a work item, with the consequences for others; returns the number of changed rows.
    pub(crate) async fn execute_change(self, database: &Database) -> Result<u64> {
        let changed = self.execute(database).await?;
        if changed > 0 {
            database.apply_transitions().await;
        }
        Ok(changed)
    }
}

impl Transaction {
    async fn of_file(pool: &SqlitePool, writers: &Writers) -> Result<Self> {
        let (transaction, turn) = sqlite::write(pool, writers).await?;
        Ok(Transaction::Sqlite { transaction, _turn: Some(turn) })
    }

    pub(crate) fn commit(self) -> BoxFuture<'static, Result<()>> {
        Box::pin(async move {
            match self {
                Transaction::Sqlite { transaction, .. } => transaction.commit().await?,
                Transaction::Postgres(transaction) => transaction.commit().await?,
            }
            Ok(())
        })
    }

    /// The same, without waiting for the disk if the engine does that by itself: a crash of the database may forget it. Once a later
    /// transaction is durable, it is too.
    pub(crate) fn commit_for_now(self) -> BoxFuture<'static, Result<()>> {
        Box::pin(async move {
            match self {
                Transaction::Sqlite { transaction, .. } => transaction.commit().await?,
                Transaction::Postgres(transaction) => transaction.commit_for_now().await?,
            }
            Ok(())
        })
    }

    pub(crate) fn rollback(self) -> BoxFuture<'static, Result<()>> {
        Box::pin(async move {
            match self {
                Transaction::Sqlite { transaction, .. } => transaction.rollback().await?,
                Transaction::Postgres(transaction) => transaction.rollback().await?,
            }
            Ok(())
        })
    }
}

impl<'c> From<&'c Database> for Session<'c> {
    fn from(database: &'c Database) -> Self {
        match database {
            Database::Sqlite(pool, _) => Session::SqlitePool(pool),
            Database::Postgres(connections) => Session::PostgresAny(connections),
        }
    }
}

impl<'c> From<&'c mut Transaction> for Session<'c> {
    fn from(transaction: &'c mut Transaction) -> Self {
        match transaction {
            Transaction::Sqlite { transaction, .. } => Session::Sqlite(transaction),
            Transaction::Postgres(transaction) => Session::Postgres(transaction.connection()),
        }
    }
}
