//! Speed of the workers' machines.

use crate::engine::query::query;
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;

impl Store {
    /// Keeps the speed of a machine for a version of the numbers, as JSON text, in place of an earlier one.
    ///
    /// # Errors
    /// The database fails.
    pub async fn keep_machine_speed(&self, host: &str, physics_version: i64, speed_json: &str) -> Result<()> {
        query(sql::machine::KEEP_SPEED)
            .bind(host)
            .bind(physics_version)
            .bind(speed_json)
            .execute(&self.database)
            .await?;
        Ok(())
    }

    /// The speed measured last of any machine with this version of the numbers, as JSON text; none before a worker has
    /// started.
    ///
    /// # Errors
    /// The database fails.
    pub async fn machine_speed(&self, physics_version: i64) -> Result<Option<String>> {
        query(sql::machine::LATEST_SPEED).bind(physics_version).first_scalar(&self.database).await
    }
}
