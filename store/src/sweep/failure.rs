//! Points that failed, over all sweeps.

use crate::engine::query::{Row, query};
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;
use crate::sweep::point::PointRecord;

/// A point that failed for good.
#[derive(Debug, Clone, PartialEq)]
pub struct FailureRecord {
    /// The sweep.
    pub sweep_id: String,
    /// The sweep's name.
    pub sweep_name: Option<String>,
    /// Owner of the sweep.
    pub owner: String,
    /// Time of the failure \[ms since the epoch\].
    pub at: i64,
    /// The point, without scenario and result.
    pub point: PointRecord,
}

/// Filter of failures; absent members let all through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FailureFilter<'a> {
    /// Owner of the sweeps.
    pub owner: Option<&'a str>,
    /// Class of the error.
    pub class: Option<&'a str>,
}

/// End of a page of failures, after which the next one continues.
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

    fn read(row: &Row) -> Result<Self> {
        Ok(Self {
            sweep_id: row.get("sweep_id")?,
            sweep_name: row.get("sweep_name")?,
            owner: row.get("owner")?,
            at: row.get("changed")?,
            point: PointRecord::read(row)?,
        })
    }
}

impl Store {
    /// Points that failed or were given up as dead, of all sweeps that are kept, the latest first; `limit` of them after
    /// a place in the list. [`verifications`](Store::verifications) reports runs that only verify a point.
    ///
    /// # Errors
    /// The database fails.
    pub async fn failures(
        &self,
        filter: &FailureFilter<'_>,
        after: Option<&FailurePlace>,
        limit: i64,
    ) -> Result<Vec<FailureRecord>> {
        let start = FailurePlace { at: i64::MAX, sweep_id: String::new(), ordinal: 0 };
        let after = after.unwrap_or(&start);
        query(sql::failure::LIST)
            .bind(after.at)
            .bind(&after.sweep_id)
            .bind(after.ordinal)
            .bind(filter.owner)
            .bind(filter.class)
            .bind(limit)
            .records(&self.database, FailureRecord::read)
            .await
    }
}
