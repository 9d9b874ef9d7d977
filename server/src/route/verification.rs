//! Verification of a sample of a sweep's points.

use std::collections::HashMap;

use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::promise_of_scenario;
use drillsweep_api::view::points::{PointSummary, PointsTable};
use drillsweep_api::view::verification::{self, Findings, VerifiedPoint};
use drillsweep_store::{Store, WorkState};
use tokio::runtime::Handle;

use crate::answer::blocking::blocking;
use crate::answer::error::{Error, Result};
use crate::answer::extract::{Path, Query};
use crate::answer::format::{Answer, Form};
use crate::answer::records;
use crate::app::App;
use crate::openapi::answers::{Conditional, Problems, TableResponse};
use crate::route::results::TableQuery;

/// Memory of a point in the table of its sweep, without its summary \[bytes\].
const MEMORY_OF_POINT: u64 = 256;

/// Memory for the table of a sweep \[bytes\], from the summary of one point. A field takes eight bytes in a column, sixteen with the
/// cached column that it is a copy of, and with its name at least forty in the summary's JSON.
pub(crate) async fn memory_of_points(app: &App, id: &str, points: u64) -> Result<u64> {
    let summary = match app.store.points(id, &[WorkState::Done], 0, 1).await?.first() {
        Some(one) => app.store.point(id, one.ordinal).await?.and_then(|point| point.summary_json),
        None => None,
    };
    let summary = summary.map_or(0, |summary| summary.len() as u64);
    Ok(points.saturating_mul(MEMORY_OF_POINT + summary * 2 / 5))
}

/// Number of points of a sweep's table that are read at once.
pub(crate) const PAGE: i64 = 500;

/// Verified points of a sweep, and findings.
#[derive(Default)]
pub(crate) struct Verified {
    pub(crate) points: Vec<VerifiedPoint>,
    pub(crate) findings: Findings,
}

impl Verified {
    /// Loads the verified points of a sweep; empty if it verifies none.
    pub(crate) async fn load(store: &Store, id: &str) -> Result<Self> {
        let records = store.verifications(id).await?;
        let Some(first) = records.first() else { return Ok(Self::default()) };
        // The accuracy preset, which alone makes a promise, is the same for all points, so that one is enough.
        let scenario = store.point(id, first.ordinal).await?.and_then(|point| point.scenario);
        blocking(move || {
            let points: Vec<VerifiedPoint> =
                records.iter().map(records::verified_point).collect::<Result<_>>()?;
            let promise = scenario.and_then(|scenario| promise_of_scenario(&scenario.base_json));
            let findings = Findings::new(&points, promise);
            Ok(Self { points, findings })
        })
        .await
    }

    /// Table of `points` points of the sweep, with biases of verified ones. Blocks.
    pub(crate) fn points(
        &self,
        store: &Store,
        id: &str,
        points: u64,
        runtime: &Handle,
    ) -> Result<PointsTable> {
        let mut table = PointsTable::for_rows(usize::try_from(points).unwrap_or_default());
        self.each_point(store, id, runtime, |point| table.push(point))?;
        Ok(table)
    }

    /// Visits the points of the sweep, with biases of verified ones. Pages are read one after the other, each in its present state. Blocks.
    pub(crate) fn each_point(
        &self,
        store: &Store,
        id: &str,
        runtime: &Handle,
        mut visit: impl FnMut(PointSummary) -> serde_json::Result<()>,
    ) -> Result<()> {
        let by_ordinal: HashMap<i64, &VerifiedPoint> =
            self.points.iter().map(|point| (point.ordinal.into(), point)).collect();
        let read = |after| {
            let (store, id) = (store.clone(), id.to_owned());
            runtime.spawn(async move { store.table_rows(&id, after, PAGE).await })
        };
        let mut next = read(0);
        loop {
            let mut page = runtime.block_on(next).map_err(|error| Error::internal(&error))??;
            let Some(last) = page.last() else { break };
            // The database reads the next page while this one is parsed.
            next = read(last.ordinal);
            for record in &mut page {
                let biases = by_ordinal.get(&record.ordinal).map(|point| point.biases()).unwrap_or_default();
                let point = PointSummary { biases, ..records::point_summary(record)? };
                visit(point).map_err(|error| Error::internal(&error))?;
            }
        }
        // If the sweep was deleted between two pages, the points so far are not its table.
        if runtime.block_on(store.sweep_version(id))?.is_none() {
            return Err(records::no_such_sweep(id));
        }
        Ok(())
    }

    /// Table of the verified points.
    pub(crate) fn table(&self) -> drillsweep_table::Table {
        verification::verification(&self.points, &self.findings)
    }
}

/// Results of verifying a sample of the points
///
/// A row a verified point: `ordinal`, parameters, the `state` of the reference run, and for each statistic NAME (orbit sizes, standard
/// deviations of the radius, mean radii, frequencies of the strongest lines; of ensembles the means over the members) the point's value,
/// that of the reference as `reference_NAME`, and the bias as `bias_NAME`: relative to the reference, for frequencies in Hz. The attribute
/// `statistics` summarises them by NAME: the number of points `verified`, the `mean` bias with its 95 % `interval`, the `largest` bias with
/// its point (`largest_at`), the bound `promised` by the sweep's accuracy, and the number of points `exceeding` it; `warnings` reports the
/// latter in words. A sweep without verification has no rows.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/verification",
    tag = "sweeps",
    operation_id = "get_sweep_verification",
    params(("id" = String, Path, description = "Identifier of the sweep"), TableQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Path(id): Path<String>,
    Query(TableQuery { format, units, fields }): Query<TableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(format, units, &headers)?;
    if app.store.sweep_version(&id).await?.is_none() {
        return Err(records::no_such_sweep(&id));
    }
    let verified = Verified::load(&app.store, &id).await?;
    let place = app.view(memory_of_points(&app, &id, verified.points.len() as u64).await?).await?;
    place
        .answer(move || {
            let name = format!("sweep-{id}-verification");
            Answer::of_table(verified.table(), fields.as_deref(), form, &name, None)
        })
        .await
}

#[cfg(test)]
mod tests {
    use drillsweep_store::{Role, StoreConfig};

    use super::*;

    #[tokio::test]
    async fn the_remainder_of_a_deleted_sweep_is_no_table() {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let config = StoreConfig::in_directory(directory.path(), Role::Server);
        let store = Store::open(&config).await.expect("a store");
        let runtime = Handle::current();
        // The state that the page after the deletion finds.
        let read = move || Verified::default().points(&store, "deleted", 0, &runtime).map(|_| ());
        let problem = blocking(read).await.map_err(Error::into_problem).expect_err("no table");
        assert_eq!(problem.status, 404);
    }
}
