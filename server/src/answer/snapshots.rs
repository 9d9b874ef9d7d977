//! Stored snapshots of a string: their times, and the motion of single nodes.

use std::ops::Range;

use drillsweep_api::view::history;
use drillsweep_api::view::snapshots::SnapshotTimes;
use drillsweep_quantity::columns::TIME;
use drillsweep_table::parquet::{Cut, StoredTable};
use drillsweep_table::{Column, Table};

use crate::answer::error::{Error, Result};
use crate::answer::format;
use crate::answer::stored::{Stored, StoredFile};

/// Stored snapshots of a string, with its number of nodes.
pub(crate) struct Snapshots {
    stored: Stored,
    nodes: usize,
}

impl Snapshots {
    /// Snapshots of a table with a row a node, from the top, snapshot after snapshot; `statics` has a row for each node of the string.
    ///
    /// # Errors
    /// The table's rows are no snapshots of the string's number of nodes.
    pub(crate) fn new(stored: Stored, statics: &Stored) -> Result<Self> {
        let (rows, nodes) = (stored.rows(), statics.rows());
        if nodes == 0 || !rows.is_multiple_of(nodes) {
            return Err(Error::internal(&format!("{rows} rows are no snapshots of {nodes} nodes")));
        }
        let nodes = usize::try_from(nodes).map_err(|_| Error::internal("a string of too many nodes"))?;
        Ok(Self { stored, nodes })
    }

    /// The table.
    pub(crate) fn stored(&self) -> &Stored {
        &self.stored
    }

    /// The table, by value.
    pub(crate) fn into_stored(self) -> Stored {
        self.stored
    }

    /// The number of snapshots.
    pub(crate) fn count(&self) -> usize {
        usize::try_from(self.stored.rows()).unwrap_or(usize::MAX) / self.nodes
    }

    /// Number of nodes: the rows of a snapshot.
    pub(crate) fn nodes(&self) -> usize {
        self.nodes
    }

    /// Times of the snapshots \[s\]. Blocks.
    pub(crate) fn times(&self, table: &StoredTable<StoredFile>) -> Result<SnapshotTimes> {
        let rows = table.rows();
        let time = |row: usize| {
            let read = table.read(&[TIME.name], row..row + 1).map_err(|error| self.stored.problem(error))?;
            match read.columns.get(TIME.name) {
                Some(Column::Number(times)) => Ok(times.first().copied().unwrap_or(0.0)),
                _ => Err(Error::internal("a table of snapshots without times")),
            }
        };
        let (first, last) = (time(0)?, time(rows.saturating_sub(1))?);
        Ok(SnapshotTimes { first, last, count: rows / self.nodes })
    }

    /// Every `stride`-th of a range of snapshots, with all nodes or one, in the columns of `layout`.
    ///
    /// # Errors
    /// A column of `layout` is not in the `table`.
    pub(crate) fn part(
        &self,
        table: StoredTable<StoredFile>,
        layout: Table,
        frames: &Range<usize>,
        (node, stride): (Option<usize>, usize),
    ) -> Result<Cut<StoredFile>> {
        let (start, end) = (frames.start * self.nodes, frames.end * self.nodes);
        Ok(match node {
            None => table.cut_runs(layout, start..end, self.nodes, stride)?,
            Some(node) => {
                table.cut(layout, (start + node.saturating_sub(1)).min(end)..end, self.nodes * stride)?
            }
        })
    }

    /// Time and columns of the lowest node in the half-open window \[from, to) \[s\], of at most `most` snapshots; `None` if a column is
    /// missing. Blocks.
    pub(crate) fn of_lowest_node(
        &self,
        columns: &[&str],
        [from, to]: [Option<f64>; 2],
        most: usize,
    ) -> Result<Option<Table>> {
        let table = self.stored.open()?;
        if !columns.iter().all(|name| table.layout().columns.contains_key(*name)) {
            return Ok(None);
        }
        let frames = self.times(&table)?.window(from, to);
        let stride = history::stride(frames.len(), Some(most));
        let wanted: Vec<String> =
            std::iter::once(&TIME.name).chain(columns).map(|name| (*name).to_owned()).collect();
        let layout = format::select(table.layout().clone(), Some(&wanted))?;
        let part = self.part(table, layout, &frames, (Some(self.nodes), stride))?;
        Ok(Some(part.read().map_err(|error| self.stored.problem(error))?.widened()))
    }
}
