//! The register of workers.

use crate::engine::query::{Row, query};
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;

/// A worker process as it registered itself.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkerRecord {
    /// Identifier, made by the worker.
    pub id: String,
    /// Host it runs on.
    pub host: String,
    /// Its process number there.
    pub process: i64,
    /// Version of its program.
    pub version: String,
    /// Version of its numbers.
    pub physics_version: i64,
    /// Time of its start \[ms since the epoch\].
    pub started: i64,
    /// Time of its last heartbeat \[ms since the epoch\].
    pub last_seen: i64,
}

impl Store {
    /// Registers a worker, or renews its entry. The times of `worker` are taken from the database's clock.
    ///
    /// # Errors
    /// The database fails.
    pub async fn register_worker(&self, worker: &WorkerRecord) -> Result<()> {
        query(sql::worker::REGISTER)
            .bind(&worker.id)
            .bind(&worker.host)
            .bind(worker.process)
            .bind(&worker.version)
            .bind(worker.physics_version)
            .execute(&self.database)
            .await?;
        Ok(())
    }

    /// Removes a worker that ends.
    ///
    /// # Errors
    /// The database fails.
    pub async fn remove_worker(&self, id: &str) -> Result<()> {
        query(sql::worker::REMOVE).bind(id).execute(&self.database).await?;
        Ok(())
    }

    /// Expires the leases of a process that its supervisor reports as dead, with a note about its end (as
    /// [`note_worker`](Self::note_worker)); the next claim ends them. Returns their number.
    ///
    /// # Errors
    /// The database fails.
    pub async fn bury_worker(&self, host: &str, process: i64, note: Option<&str>) -> Result<u64> {
        let ended = query(sql::worker::END_LEASES)
            .bind(host)
            .bind(process)
            .bind(note)
            .execute(&self.database)
            .await?;
        query(sql::worker::REMOVE_PROCESS).bind(host).bind(process).execute(&self.database).await?;
        Ok(ended)
    }

    /// Workers with a heartbeat within the last `within_ms` milliseconds, oldest first. A heartbeat too far in the future, as after the
    /// clock was set back, does not count.
    ///
    /// # Errors
    /// The database fails.
    pub async fn workers(&self, within_ms: i64) -> Result<Vec<WorkerRecord>> {
        query(sql::worker::LIST).bind(within_ms).records(&self.database, WorkerRecord::read).await
    }
}

impl WorkerRecord {
    fn read(row: &Row) -> Result<Self> {
        Ok(Self {
            id: row.get("id")?,
            host: row.get("host")?,
            process: row.get("process")?,
            version: row.get("version")?,
            physics_version: row.get("physics_version")?,
            started: row.get("started")?,
            last_seen: row.get("last_seen")?,
        })
    }
}
