//! Sweeps as they are stored.

use std::collections::HashMap;

use crate::engine::query::{Row, query};
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;
use crate::work::state::StateCounts;

/// A stored sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRecord {
    /// Identifier.
    pub id: String,
    /// A name for people.
    pub name: Option<String>,
    /// Owner, whose share of the workers it counts against.
    pub owner: String,
    /// Names of the parameters that it varies, in the order of its request, as a JSON array.
    pub varied_json: String,
    /// Higher goes first.
    pub priority: i64,
    /// Raised with every change of one of its points.
    pub version: i64,
    /// Raised with every requested change.
    pub revision: i64,
    /// True once it was cancelled.
    pub is_cancelled: bool,
    /// True while its points are not handed out.
    pub is_paused: bool,
    /// True if the sweep and its data are kept regardless of age.
    pub is_pinned: bool,
    /// Time from which it may be deleted \[ms since the epoch\].
    pub expires: Option<i64>,
    /// Words to find it by, as a JSON array.
    pub tags_json: String,
    /// Time of its submission \[ms since the epoch\].
    pub created: i64,
    /// Time at which its last point became final \[ms since the epoch\].
    pub finished: Option<i64>,
    /// Points by state.
    pub counts: StateCounts,
    /// Runs that verify points, by state.
    pub verification: StateCounts,
    /// Sum of the progress of points and of the runs that verify them, each 0 to 1; one that is final counts whole.
    pub progress: f64,
}

/// Filter of sweeps; absent members let all through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SweepFilter<'a> {
    /// Owner.
    pub owner: Option<&'a str>,
    /// In this state: `running`, `paused`, `completed` or `cancelled`.
    pub state: Option<&'a str>,
    /// Text in the name, ignoring the case of ASCII letters.
    pub name: Option<&'a str>,
    /// With this tag.
    pub tag: Option<&'a str>,
    /// With an identifier that begins like this.
    pub id: Option<&'a str>,
}

impl Store {
    /// A sweep with its counts; none if there is no such sweep.
    ///
    /// # Errors
    /// The database fails.
    pub async fn sweep(&self, id: &str) -> Result<Option<SweepRecord>> {
        self.apply_left_transitions().await;
        query(sql::sweep::ONE).bind(id).first_record(&self.database, SweepRecord::read).await
    }

    /// Request of a sweep as JSON; none if there is no such sweep.
    ///
    /// # Errors
    /// The database fails.
    pub async fn request_json(&self, id: &str) -> Result<Option<String>> {
        query(sql::sweep::REQUEST).bind(id).first_scalar(&self.database).await
    }

    /// Length of a sweep's request \[bytes\]; none if there is no such sweep.
    ///
    /// # Errors
    /// The database fails.
    pub async fn request_bytes(&self, id: &str) -> Result<Option<i64>> {
        query(sql::sweep::REQUEST_BYTES).bind(id).first_scalar(&self.database).await
    }

    /// Sweeps, newest first, those that the filter lets through, before the sweep `before`.
    ///
    /// # Errors
    /// The database fails.
    pub async fn sweeps(
        &self,
        filter: &SweepFilter<'_>,
        before: Option<&str>,
        limit: i64,
    ) -> Result<Vec<SweepRecord>> {
        self.apply_left_transitions().await;
        query(sql::sweep::LIST)
            .bind(filter.owner)
            .bind(before)
            .bind(limit)
            .bind(filter.state)
            .bind(filter.name)
            .bind(filter.tag)
            .bind(filter.id)
            .records(&self.database, SweepRecord::read)
            .await
    }

    /// Versions of the numbers of some sweeps, by sweep.
    ///
    /// # Errors
    /// The database fails.
    pub async fn physics_versions(&self, sweeps: &[&str]) -> Result<HashMap<String, i64>> {
        let sweeps = serde_json::json!(sweeps).to_string();
        let versions: Vec<(String, i64)> =
            query(sql::sweep::PHYSICS_VERSIONS).bind(sweeps).rows(&self.database).await?;
        Ok(versions.into_iter().collect())
    }

    /// A number that rises with every change of the sweep's points; none if there is no such sweep.
    ///
    /// # Errors
    /// The database fails.
    pub async fn sweep_version(&self, id: &str) -> Result<Option<i64>> {
        self.apply_left_transitions().await;
        query(sql::sweep::VERSION).bind(id).first_scalar(&self.database).await
    }
}

impl SweepRecord {
    pub(crate) fn read(row: &Row) -> Result<Self> {
        let counts = StateCounts {
            total: row.get("points")?,
            queued: row.get("points_queued")?,
            running: row.get("points_running")?,
            done: row.get("points_done")?,
            failed: row.get("points_failed")?,
            cancelled: row.get("points_cancelled")?,
        };
        let verification = StateCounts {
            total: row.get("verifications")?,
            queued: row.get("verifications_queued")?,
            running: row.get("verifications_running")?,
            done: row.get("verifications_done")?,
            failed: row.get("verifications_failed")?,
            cancelled: row.get("verifications_cancelled")?,
        };
        let running_progress: f64 = row.get("running_progress")?;
        Ok(Self {
            id: row.get("id")?,
            name: row.get("name")?,
            owner: row.get("owner")?,
            varied_json: row.get("varied")?,
            priority: row.get("priority")?,
            version: row.get("version")?,
            revision: row.get("revision")?,
            is_cancelled: row.get("cancelled")?,
            is_paused: row.get("paused")?,
            is_pinned: row.get("pinned")?,
            expires: row.get("expires")?,
            tags_json: row.get("tags")?,
            created: row.get("created")?,
            finished: row.get("finished")?,
            counts,
            verification,
            progress: (counts.final_ones() + verification.final_ones()) as f64 + running_progress,
        })
    }
}
