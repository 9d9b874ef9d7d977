//! Events of the points of a sweep, in order.

use crate::engine::query::query;
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;
use crate::work::state::{WorkKey, WorkState, work_key};

/// A change of a work item that a sweep has among its points.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Event {
    /// The sweep's version after the change: it rises, with gaps if the sweep itself changed or ended.
    pub seq: i64,
    /// The new state.
    pub state: WorkState,
    /// The work item.
    pub work_key: WorkKey,
    /// Numbers of the points of the sweep that have it, from 1.
    pub ordinals: Vec<u32>,
    /// Numbers of the points that it verifies.
    pub verifies: Vec<u32>,
    /// Time of the event \[ms since the epoch\].
    pub at: i64,
}

impl Store {
    /// Events of a sweep after the number `after`, oldest first.
    ///
    /// # Errors
    /// The database fails.
    pub async fn events(&self, sweep_id: &str, after: i64, limit: i64) -> Result<Vec<Event>> {
        type Row = (i64, String, Vec<u8>, i64, Option<String>, Option<String>);
        self.apply_left_transitions().await;
        let rows: Vec<Row> =
            query(sql::event::LIST).bind(sweep_id).bind(after).bind(limit).rows(&self.database).await?;
        if !rows.is_empty() {
            // Nobody hears of an event that a crash of the database may forget: its number would be given again.
            query(sql::event::MAKE_DURABLE).scalars::<i32>(&self.database).await?;
        }
        rows.into_iter()
            .map(|(seq, kind, key, at, ordinals, verifies)| {
                let state = WorkState::parse(&kind)?;
                let (ordinals, verifies) = (numbers(ordinals.as_deref()), numbers(verifies.as_deref()));
                Ok(Event { seq, state, work_key: work_key(&key)?, ordinals, verifies, at })
            })
            .collect()
    }
}

/// A list of numbers, in order.
fn numbers(list: Option<&str>) -> Vec<u32> {
    let mut numbers: Vec<u32> =
        list.into_iter().flat_map(|list| list.split(',')).filter_map(|number| number.parse().ok()).collect();
    numbers.sort_unstable();
    numbers
}
