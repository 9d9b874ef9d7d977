//! Cache of the columns of sweeps' tables, which are found by reading the results of all points.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use drillsweep_api::ColumnList;

/// Sweeps whose columns are kept, of some kilobytes each.
const MOST: usize = 64;

/// Columns of the sweeps that were requested last.
#[derive(Debug, Default)]
pub(crate) struct KnownColumns(Mutex<VecDeque<Known>>);

#[derive(Debug)]
struct Known {
    sweep: String,
    version: i64,
    columns: ColumnList,
}

impl KnownColumns {
    /// Columns of a sweep at this version, if they are kept.
    pub(crate) fn get(&self, sweep: &str, version: i64) -> Option<ColumnList> {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.iter().find(|known| known.sweep == sweep && known.version == version)?;
        Some(found.columns.clone())
    }

    /// Keeps the columns of a sweep in place of the oldest ones.
    pub(crate) fn put(&self, sweep: String, version: i64, columns: ColumnList) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|known| known.sweep != sweep);
        known.push_back(Known { sweep, version, columns });
        if known.len() > MOST {
            known.pop_front();
        }
    }
}
