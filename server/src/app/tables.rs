//! Cache of the tables of sweeps, which are found by reading the results of all points.

use std::sync::Arc;

use drillsweep_api::view::points::PointsTable;
use quick_cache::Weighter;
use quick_cache::sync::Cache;

use crate::answer::error::{Error, Result};

/// Memory of all tables that are kept \[bytes\]; a table that needs more is not kept.
const MEMORY: u64 = 40 << 20;

/// Number of tables of usual size that are kept. The cache divides its memory into shards of at least 32 tables, each of which would keep
/// only tables of its part; fewer make one shard.
const USUAL: usize = 16;

type Version = (String, i64);

/// Tables by sweep and version.
pub(crate) struct Tables(Cache<Version, Arc<PointsTable>, Size>);

#[derive(Clone)]
struct Size;

impl Weighter<Version, Arc<PointsTable>> for Size {
    fn weight(&self, (id, _): &Version, table: &Arc<PointsTable>) -> u64 {
        (id.len() + table.memory()) as u64 + 200
    }
}

impl Tables {
    pub(crate) fn new() -> Self {
        Self(Cache::with_weighter(USUAL, MEMORY, Size))
    }

    /// True if a table fits, by the memory of an answer from it, of which its values are half \[bytes\].
    pub(crate) fn fits(memory: u64) -> bool {
        memory / 2 <= MEMORY
    }

    /// Table of a sweep at a version, read if it is not kept; while one request reads it, others wait for it. Blocks.
    ///
    /// # Errors
    /// Errors of reading; the next request reads again.
    pub(crate) fn get_or_read(
        &self,
        id: &str,
        version: i64,
        read: impl FnOnce() -> Result<PointsTable>,
    ) -> Result<Arc<PointsTable>> {
        self.0.get_or_insert_with::<_, Error>(&(id.to_owned(), version), || Ok(Arc::new(read()?)))
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_api::PointState;
    use drillsweep_api::view::points::PointSummary;
    use indexmap::IndexMap;

    use super::*;

    fn table(rows: u32) -> PointsTable {
        let mut table = PointsTable::for_rows(rows as usize);
        for ordinal in 1..=rows {
            let point = PointSummary {
                ordinal,
                state: PointState::Succeeded,
                parameters: IndexMap::new(),
                summary: Some(r#"{"a": 0.5, "b": 1, "c": "d"}"#.to_owned()),
                biases: IndexMap::new(),
                error: None,
            };
            table.push(point).expect("a row");
        }
        table
    }

    #[test]
    fn a_table_is_read_once_a_version() {
        let tables = Tables::new();
        let unread = || -> Result<PointsTable> { panic!("read again") };
        // Of the size of most of the memory, which one shard alone would keep.
        let rows = 150_000;
        let first = tables.get_or_read("a", 1, || Ok(table(rows))).expect("a table");
        assert!(first.memory() as u64 > MEMORY / 2, "{}", first.memory());
        assert!(Arc::ptr_eq(&first, &tables.get_or_read("a", 1, unread).expect("a table")));
        let second = tables.get_or_read("a", 2, || Ok(table(2))).expect("a table");
        assert_eq!(Arc::unwrap_or_clone(second).finish(None).rows(), 2);
        assert!(tables.0.weight() <= MEMORY, "{}", tables.0.weight());
    }

    #[test]
    fn a_table_above_the_memory_is_not_kept() {
        let tables = Tables::new();
        let large = tables.get_or_read("a", 1, || Ok(table(400_000))).expect("a table");
        assert!(large.memory() as u64 > MEMORY);
        assert_eq!(Arc::strong_count(&large), 1);
    }
}
