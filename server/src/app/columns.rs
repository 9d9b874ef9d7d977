//! Columns of sweeps' tables that were found: for that, the results of all points are read.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use drillsweep_api::ColumnList;

/// Sweeps whose columns are kept: some kilobytes each.
const MOST: usize = 64;

/// The columns of the sweeps that were asked about last.
#[derive(Debug, Default)]
pub(crate) struct KnownColumns(Mutex<VecDeque<Known>>);

#[derive(Debug)]
struct Known {
    sweep: String,
    version: i64,
    columns: ColumnList,
}

impl KnownColumns {
    /// Columns of a sweep, if it has this version still.
    pub(crate) fn get(&self, sweep: &str, version: i64) -> Option<ColumnList> {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.iter().find(|known| known.sweep == sweep && known.version == version)?;
        Some(found.columns.clone())
    }

    /// Keeps those of a sweep, in the place of others that were kept first.
    pub(crate) fn put(&self, sweep: String, version: i64, columns: ColumnList) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|known| known.sweep != sweep);
        known.push_back(Known { sweep, version, columns });
        if known.len() > MOST {
            known.pop_front();
        }
    }
}
