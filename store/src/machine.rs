//! How fast the machines of the workers are.

use crate::connection::{Store, now};
use crate::error::Result;

impl Store {
    /// Keeps the speed of a machine for a version of the numbers, as JSON text, in place of an earlier one.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn keep_machine_speed(&self, host: &str, physics_version: i64, speed_json: &str) -> Result<()> {
        let query = concat!(
            "INSERT INTO machine_speed (host, physics_version, speed, measured) VALUES (?2, ?3, ?4, ",
            now!(),
            ") ON CONFLICT (host, physics_version) DO UPDATE SET speed = excluded.speed, measured = excluded.measured"
        );
        sqlx::query(query)
            .bind(self.clock_offset_ms)
            .bind(host)
            .bind(physics_version)
            .bind(speed_json)
            .execute(&self.pool)
            .await?;
        Ok(())
    }

    /// The speed measured last of any machine with this version of the numbers, as JSON text; none before a worker has
    /// started.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn machine_speed(&self, physics_version: i64) -> Result<Option<String>> {
        let query =
            "SELECT speed FROM machine_speed WHERE physics_version = ?1 ORDER BY measured DESC, host LIMIT 1";
        Ok(sqlx::query_scalar(query).bind(physics_version).fetch_optional(&self.pool).await?)
    }
}
