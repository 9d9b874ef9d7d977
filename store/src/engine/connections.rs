//! Connections to a PostgreSQL server: a pool, and one in addition for single users.
//!
//! The pool pings each returned connection and reuses it last. A worker, whose statements are sequential, would send two messages for each
//! statement and cycle through all connections of the pool, each with its own copy of schema and plans on the server. The connection used
//! last is therefore kept outside of the pool for the next user; concurrent users take connections of the pool.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;
use std::time::{Duration, Instant};

use sqlx::pool::PoolConnection;
use sqlx::postgres::{PgConnection, PgPool};
use sqlx::{Connection as _, Postgres};
use tokio::sync::{Mutex, OwnedMutexGuard};

/// Time for which a connection is trusted after its last use; later it is tested first, which takes a message and its
/// answer.
pub(super) const TRUSTED_FOR: Duration = Duration::from_secs(1);

/// Timeout of a new connection, and of the test of an old one.
pub(super) const CONNECT_TIMEOUT: Duration = Duration::from_secs(30);

/// Longest life of a kept connection, as long as the pool keeps its own: the server's memory of it grows with its use.
const KEPT_FOR: Duration = Duration::from_mins(30);

/// Connections to a server. Cheap to clone.
#[derive(Debug, Clone)]
pub(crate) struct Connections {
    pool: PgPool,
    at_hand: Arc<Mutex<Option<AtHand>>>,
}

/// Numbers of connections.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ConnectionNumbers {
    /// Connections that are open.
    pub(crate) open: u32,
    /// Number of idle ones among them.
    pub(crate) idle: u32,
}

/// A connection that is not of the pool any more.
#[derive(Debug)]
pub(crate) struct AtHand {
    connection: PgConnection,
    made: Instant,
    used: Instant,
}

/// A connection in use. Without a return it is closed, so that the server rolls back its transaction.
pub(crate) enum Lent {
    Own(Box<AtHand>, OwnedMutexGuard<Option<AtHand>>),
    OfPool(Pooled),
}

/// A connection of the pool, which closes it if its last statement has not been answered.
pub(crate) struct Pooled {
    connection: PoolConnection<Postgres>,
    is_answered: bool,
}

impl Connections {
    /// Takes the pool, which has one connection fewer than there may be.
    pub(super) fn new(pool: PgPool) -> Self {
        Self { pool, at_hand: Arc::default() }
    }

    /// The pool, for users that keep a connection.
    pub(crate) fn pool(&self) -> &PgPool {
        &self.pool
    }

    /// A connection: the kept one, or one of the pool if that is in use.
    ///
    /// # Errors
    /// No connection can be made, or none becomes free in time.
    pub(crate) async fn lend(&self) -> sqlx::Result<Lent> {
        let Ok(mut at_hand) = Arc::clone(&self.at_hand).try_lock_owned() else {
            return Ok(Lent::OfPool(Pooled { connection: self.pool.acquire().await?, is_answered: false }));
        };
        if let Some(mut own) = at_hand.take()
            && own.made.elapsed() <= KEPT_FOR
            && own.is_there().await
        {
            return Ok(Lent::Own(Box::new(own), at_hand));
        }
        let connection = self.pool.acquire().await?.detach();
        let now = Instant::now();
        Ok(Lent::Own(Box::new(AtHand { connection, made: now, used: now }), at_hand))
    }

    /// Connections of the pool and the additional one.
    pub(crate) fn numbers(&self) -> ConnectionNumbers {
        let (open, idle) = (self.pool.size(), self.pool.num_idle() as u32);
        match self.at_hand.try_lock() {
            Ok(at_hand) => {
                let at_hand = u32::from(at_hand.is_some());
                ConnectionNumbers { open: open + at_hand, idle: idle + at_hand }
            }
            Err(_) => ConnectionNumbers { open: open + 1, idle },
        }
    }

    /// Closes all connections; those in use once they are given back.
    pub(crate) async fn close(&self) {
        if let Some(own) = self.at_hand.lock().await.take() {
            // A broken connection need not be closed.
            let _ = own.connection.close().await;
        }
        self.pool.close().await;
    }
}

impl AtHand {
    async fn is_there(&mut self) -> bool {
        let is_trusted = self.used.elapsed() <= TRUSTED_FOR;
        is_trusted
            || matches!(tokio::time::timeout(CONNECT_TIMEOUT, self.connection.ping()).await, Ok(Ok(())))
    }
}

impl Lent {
    /// Gives it back after a statement that was answered in full, and with no transaction begun, so that the next one has it.
    pub(crate) fn give_back(self) {
        match self {
            Lent::Own(own, mut at_hand) => *at_hand = Some(AtHand { used: Instant::now(), ..*own }),
            Lent::OfPool(mut pooled) => pooled.is_answered = true,
        }
    }
}

impl Drop for Pooled {
    fn drop(&mut self) {
        if !self.is_answered {
            self.connection.close_on_drop();
        }
    }
}

impl Deref for Lent {
    type Target = PgConnection;

    fn deref(&self) -> &PgConnection {
        match self {
            Lent::Own(own, _) => &own.connection,
            Lent::OfPool(pooled) => &pooled.connection,
        }
    }
}

impl DerefMut for Lent {
    fn deref_mut(&mut self) -> &mut PgConnection {
        match self {
            Lent::Own(own, _) => &mut own.connection,
            Lent::OfPool(pooled) => &mut pooled.connection,
        }
    }
}
