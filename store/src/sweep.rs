//! Sweeps: reading, changing, pausing, cancelling, retrying.

use sqlx::sqlite::SqliteRow;
use sqlx::{Row as _, Sqlite, Transaction};

use crate::connection::Store;
use crate::error::Result;
use crate::sql;
use crate::state::StateCounts;
use crate::submit::{PLACE_OF_A_POINT, end_of_order};

/// A stored sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRecord {
    /// Identifier.
    pub id: String,
    /// A name for people.
    pub name: Option<String>,
    /// Whose share of the workers it counts against.
    pub owner: String,
    /// The request as JSON.
    pub request_json: String,
    /// Higher goes first.
    pub priority: i64,
    /// Raised with every change of one of its points.
    pub version: i64,
    /// True once it was cancelled.
    pub is_cancelled: bool,
    /// True while its points are not handed out.
    pub is_paused: bool,
    /// True where it and all that belongs to it is kept whatever its age.
    pub is_pinned: bool,
    /// When it is to be deleted \[ms since the epoch\].
    pub expires: Option<i64>,
    /// Words to find it by, as a JSON array.
    pub tags_json: String,
    /// When it was submitted \[ms since the epoch\].
    pub created: i64,
    /// When its last point became final \[ms since the epoch\].
    pub finished: Option<i64>,
    /// Points by state.
    pub counts: StateCounts,
    /// Runs that verify points, by state.
    pub verification: StateCounts,
    /// Sum of the progress of points and of the runs that verify them, each 0 to 1; one that is final counts whole.
    pub progress: f64,
}

/// Which sweeps are listed; what is absent lets all through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SweepFilter<'a> {
    /// Of this owner.
    pub owner: Option<&'a str>,
    /// In this state: `running`, `paused`, `completed` or `cancelled`.
    pub state: Option<&'a str>,
    /// With this text in their name, in whatever case of ASCII letters.
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
    /// When the database fails.
    pub async fn sweep(&self, id: &str) -> Result<Option<SweepRecord>> {
        let row = sqlx::query(sql::sweep::ONE).bind(id).fetch_optional(&self.pool).await?;
        row.as_ref().map(SweepRecord::read).transpose()
    }

    /// Sweeps, newest first, those that the filter lets through, before the sweep `before`.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn sweeps(
        &self,
        filter: &SweepFilter<'_>,
        before: Option<&str>,
        limit: i64,
    ) -> Result<Vec<SweepRecord>> {
        let rows = sqlx::query(sql::sweep::LIST)
            .bind(filter.owner)
            .bind(before)
            .bind(limit)
            .bind(filter.state)
            .bind(filter.name)
            .bind(filter.tag)
            .bind(filter.id)
            .fetch_all(&self.pool)
            .await?;
        rows.iter().map(SweepRecord::read).collect()
    }

    /// A number that rises with every change of the sweep's points; none if there is no such sweep.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn sweep_version(&self, id: &str) -> Result<Option<i64>> {
        Ok(sqlx::query_scalar(sql::sweep::VERSION).bind(id).fetch_optional(&self.pool).await?)
    }

    /// Cancels a sweep: its points that no other live sweep wants are cancelled, and the runs that verify them; those under way as
    /// soon as their worker hears of it. False if there is no such sweep.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn cancel_sweep(&self, id: &str) -> Result<bool> {
        let mut tx = self.write().await?;
        let changed = sqlx::query(sql::sweep::CANCEL).bind(id).execute(&mut *tx).await?.rows_affected();
        if changed == 0 {
            return Ok(false);
        }
        sqlx::query(sql::sweep::CANCEL_WORK).bind(id).execute(&mut *tx).await?;
        hold_back(&mut tx, id).await?;
        tx.commit().await?;
        Ok(true)
    }

    /// Pauses a sweep or lets it go on: while it is paused its points are not handed out, but for those that another
    /// live sweep wants; points under way go on. False if there is no such sweep.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn pause_sweep(&self, id: &str, paused: bool) -> Result<bool> {
        let mut tx = self.write().await?;
        let changed = sqlx::query(sql::sweep::PAUSE)
            .bind(id)
            .bind(i64::from(paused))
            .execute(&mut *tx)
            .await?
            .rows_affected();
        if changed == 1 {
            hold_back(&mut tx, id).await?;
        }
        tx.commit().await?;
        Ok(changed == 1)
    }

    /// Changes what can be changed of a sweep. Work that is open takes the priority of the most urgent live sweep that has
    /// it. False if there is no such sweep.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn change_sweep(&self, id: &str, changes: &SweepChanges) -> Result<bool> {
        let mut tx = self.write().await?;
        let changed = sqlx::query(sql::sweep::CHANGE)
            .bind(id)
            .bind(changes.name.is_some())
            .bind(changes.name.as_ref().and_then(Option::as_deref))
            .bind(changes.priority)
            .bind(&changes.tags_json)
            .bind(changes.is_pinned)
            .bind(changes.expires.is_some())
            .bind(changes.expires.flatten())
            .execute(&mut *tx)
            .await?
            .rows_affected();
        if changed == 1 && changes.priority.is_some() {
            sqlx::query(sql::sweep::CHANGE_PRIORITY_OF_WORK).bind(id).execute(&mut *tx).await?;
        }
        tx.commit().await?;
        Ok(changed == 1)
    }

    /// Queues the failed and cancelled points of a sweep, and the runs that verify them, again, behind what their owner has in the
    /// queue; tells how many pieces of work that is, or none if there is no such sweep. A cancelled sweep is wanted again.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn retry_sweep(&self, id: &str) -> Result<Option<u64>> {
        let mut tx = self.write().await?;
        let owner: Option<String> =
            sqlx::query_scalar(sql::sweep::REVIVE).bind(id).fetch_optional(&mut *tx).await?;
        let Some(owner) = owner else { return Ok(None) };
        sqlx::query(sql::sweep::KEEP_RUNNING_WORK).bind(id).execute(&mut *tx).await?;
        let order = end_of_order(&mut tx, &owner).await?;
        let queued = sqlx::query(sql::sweep::RETRY_WORK)
            .bind(id)
            .bind(&owner)
            .bind(order.last)
            .bind(PLACE_OF_A_POINT)
            .execute(&mut *tx)
            .await?
            .rows_affected();
        hold_back(&mut tx, id).await?;
        tx.commit().await?;
        Ok(Some(queued))
    }
}

/// What is changed of a sweep; what is absent stays.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SweepChanges {
    /// Its name, or none any more.
    pub name: Option<Option<String>>,
    /// Its priority.
    pub priority: Option<i64>,
    /// Its tags, as a JSON array.
    pub tags_json: Option<String>,
    /// Whether it and all that belongs to it is kept whatever its age.
    pub is_pinned: Option<bool>,
    /// When it is deleted \[ms since the epoch\]: at the first collection after it, if all its points are final and it is
    /// not pinned; or never.
    pub expires: Option<Option<i64>>,
}

/// Holds back or lets go what a sweep has in the queue: work is held while only paused sweeps want it.
async fn hold_back(tx: &mut Transaction<'static, Sqlite>, id: &str) -> Result<()> {
    sqlx::query(sql::sweep::HOLD_BACK).bind(id).execute(&mut **tx).await?;
    Ok(())
}

impl SweepRecord {
    fn read(row: &SqliteRow) -> Result<Self> {
        let counts = StateCounts {
            total: row.try_get("points")?,
            queued: row.try_get("points_queued")?,
            running: row.try_get("points_running")?,
            done: row.try_get("points_done")?,
            failed: row.try_get("points_failed")?,
            cancelled: row.try_get("points_cancelled")?,
        };
        let verification = StateCounts {
            total: row.try_get("verifications")?,
            queued: row.try_get("verifications_queued")?,
            running: row.try_get("verifications_running")?,
            done: row.try_get("verifications_done")?,
            failed: row.try_get("verifications_failed")?,
            cancelled: row.try_get("verifications_cancelled")?,
        };
        let running_progress: f64 = row.try_get("running_progress")?;
        Ok(Self {
            id: row.try_get("id")?,
            name: row.try_get("name")?,
            owner: row.try_get("owner")?,
            request_json: row.try_get("request")?,
            priority: row.try_get("priority")?,
            version: row.try_get("version")?,
            is_cancelled: row.try_get("cancelled")?,
            is_paused: row.try_get("paused")?,
            is_pinned: row.try_get("pinned")?,
            expires: row.try_get("expires")?,
            tags_json: row.try_get("tags")?,
            created: row.try_get("created")?,
            finished: row.try_get("finished")?,
            counts,
            verification,
            progress: (counts.final_ones() + verification.final_ones()) as f64 + running_progress,
        })
    }
}
