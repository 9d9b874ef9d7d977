//! Points of a sweep, read for its table and its operating window.

use std::sync::Arc;

use drillsweep_api::judgement::OperatingLimits;
use drillsweep_api::view::operating_window::OperatingWindow;
use drillsweep_api::view::points::{PointSummary, PointsTable};
use drillsweep_store::{Store, SweepRecord};
use tokio::runtime::Handle;

use crate::answer::error::Result;
use crate::app::App;
use crate::app::tables::Tables;
use crate::route::verification::{PAGE, Verified, memory_of_points};

/// Points of a sweep at a version, as they are read for an answer. A table that fits into the cache is read whole and kept; of a larger one only
/// the needed columns are in memory.
pub(super) struct TablePoints {
    store: Store,
    tables: Arc<Tables>,
    runtime: Handle,
    id: String,
    version: i64,
    total: u64,
    verified: Arc<Verified>,
    /// Memory of an answer from all columns \[bytes\].
    pub(super) memory: u64,
}

/// Class of each point; absent without a result.
pub(super) type Classes = Vec<Option<String>>;

impl TablePoints {
    /// Points of a sweep, none of which is read.
    pub(super) async fn of(app: &App, sweep: &SweepRecord) -> Result<(Self, Arc<Verified>)> {
        let total = sweep.counts.total.unsigned_abs();
        let verified = Arc::new(Verified::load(&app.store, &sweep.id).await?);
        let points = Self {
            store: app.store.clone(),
            tables: app.tables.clone(),
            runtime: Handle::current(),
            id: sweep.id.clone(),
            version: sweep.version,
            total,
            verified: verified.clone(),
            memory: memory_of_points(app, &sweep.id, total).await?,
        };
        Ok((points, verified))
    }

    /// Table with all columns. Blocks.
    pub(super) fn whole(&self) -> Result<Arc<PointsTable>> {
        let read = || self.verified.points(&self.store, &self.id, self.total, &self.runtime);
        match Tables::fits(self.memory) {
            true => self.tables.get_or_read(&self.id, self.version, read),
            false => Ok(Arc::new(read()?)),
        }
    }

    /// Table with some fields of summaries, and classes by limits if there are any. Blocks.
    pub(super) fn selected(
        &self,
        kept: &[String],
        limits: Option<&OperatingLimits>,
    ) -> Result<(PointsTable, Classes)> {
        let classes_of =
            |points: &PointsTable| limits.map_or(Classes::new(), |limits| points.classes(limits));
        if Tables::fits(self.memory) {
            let points = self.whole()?;
            return Ok((points.keeping(kept), classes_of(&points)));
        }
        let mut selected = PointsTable::of_fields(kept, usize::try_from(self.total).unwrap_or_default());
        let (mut classes, mut page) = (Classes::new(), PointsTable::default());
        let mut take = |page: &mut PointsTable| {
            classes.extend(classes_of(page));
            selected.append(std::mem::take(page));
        };
        self.each(|point| {
            page.push(point)?;
            if page.len() == PAGE as usize {
                take(&mut page);
            }
            Ok(())
        })?;
        take(&mut page);
        Ok((selected, classes))
    }

    /// Operating window by limits. Blocks.
    pub(super) fn window(&self, limits: OperatingLimits) -> Result<OperatingWindow> {
        if Tables::fits(self.memory) {
            return Ok(OperatingWindow::of_table(&*self.whole()?, limits));
        }
        let mut window = OperatingWindow::new(limits);
        self.each(|point| window.push(&point))?;
        Ok(window)
    }

    fn each(&self, visit: impl FnMut(PointSummary) -> serde_json::Result<()>) -> Result<()> {
        self.verified.each_point(&self.store, &self.id, &self.runtime, visit)
    }
}
