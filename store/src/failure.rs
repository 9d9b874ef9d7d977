//! What was given up, over all sweeps.

use sqlx::FromRow;

use crate::connection::Store;
use crate::error::Result;
use crate::point::{PointRecord, PointRow};
use crate::sql;

/// A point that was given up.
#[derive(Debug, Clone, PartialEq)]
pub struct FailureRecord {
    /// The sweep.
    pub sweep_id: String,
    /// The sweep's name.
    pub sweep_name: Option<String>,
    /// Whose sweep it is.
    pub owner: String,
    /// When it was given up \[ms since the epoch\].
    pub at: i64,
    /// The point, without scenario and result.
    pub point: PointRecord,
}

/// Which failures are listed; what is absent lets all through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FailureFilter<'a> {
    /// Of sweeps of this owner.
    pub owner: Option<&'a str>,
    /// Whose error is of this class.
    pub class: Option<&'a str>,
}

/// Where a page of failures ends: the next one goes on after it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FailurePlace {
    /// As in [`FailureRecord::at`].
    pub at: i64,
    /// The sweep.
    pub sweep_id: String,
    /// The point's number in it.
    pub ordinal: i64,
}

impl FailureRecord {
    /// Its place in the list.
    pub fn place(&self) -> FailurePlace {
        FailurePlace { at: self.at, sweep_id: self.sweep_id.clone(), ordinal: self.point.ordinal }
    }
}

#[derive(FromRow)]
struct Row {
    sweep_id: String,
    sweep_name: Option<String>,
    owner: String,
    changed: i64,
    #[sqlx(flatten)]
    point: PointRow,
}

impl Store {
    /// Points that failed or were given up as dead, of all sweeps that are kept, the latest first; `limit` of them after
    /// a place in the list. Runs that only verify a point are told of by [`verifications`](Store::verifications).
    ///
    /// # Errors
    /// When the database fails.
    pub async fn failures(
        &self,
        filter: &FailureFilter<'_>,
        after: Option<&FailurePlace>,
        limit: i64,
    ) -> Result<Vec<FailureRecord>> {
        let start = FailurePlace { at: i64::MAX, sweep_id: String::new(), ordinal: 0 };
        let after = after.unwrap_or(&start);
        let rows: Vec<Row> = sqlx::query_as(sql::failure::LIST)
            .bind(after.at)
            .bind(&after.sweep_id)
            .bind(after.ordinal)
            .bind(filter.owner)
            .bind(filter.class)
            .bind(limit)
            .fetch_all(&self.pool)
            .await?;
        rows.into_iter()
            .map(|row| {
                Ok(FailureRecord {
                    sweep_id: row.sweep_id,
                    sweep_name: row.sweep_name,
                    owner: row.owner,
                    at: row.changed,
                    point: row.point.record()?,
                })
            })
            .collect()
    }
}
