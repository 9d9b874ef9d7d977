//! What verifying a sample of a sweep's points has shown.

use std::collections::HashMap;

use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::promise_of_scenario;
use drillsweep_api::view::points::PointSummary;
use drillsweep_api::view::verification::{self, Findings, VerifiedPoint};
use drillsweep_store::{Store, TableRecord};

use crate::answer::blocking::blocking;
use crate::answer::document::{Conditional, Problems, TableResponse};
use crate::answer::error::Result;
use crate::answer::extract::{Path, Query};
use crate::answer::format::{Answer, Format};
use crate::answer::records;
use crate::app::App;
use crate::route::results::TableQuery;

/// Bytes of memory that a point takes on its way into a table of its sweep.
pub(crate) const MEMORY_OF_POINT: u64 = 4 << 10;

/// The points of a sweep that are verified, and what they show.
#[derive(Default)]
pub(crate) struct Verified {
    pub(crate) points: Vec<VerifiedPoint>,
    pub(crate) findings: Findings,
}

impl Verified {
    /// Those of a sweep; none where it verifies none.
    pub(crate) async fn load(store: &Store, id: &str) -> Result<Self> {
        let records = store.verifications(id).await?;
        let Some(first) = records.first() else { return Ok(Self::default()) };
        // A preset is the same for all points of a sweep, and nothing else promises anything: one of them is enough.
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

    /// The rows of the sweep's table, with the biases of the points that are verified.
    pub(crate) fn rows(&self, records: &[TableRecord]) -> Result<Vec<PointSummary>> {
        let by_ordinal: HashMap<u32, &VerifiedPoint> =
            self.points.iter().map(|point| (point.ordinal, point)).collect();
        let row = |record| {
            let row = records::point_summary(record)?;
            let biases = by_ordinal.get(&row.ordinal).map(|point| point.biases()).unwrap_or_default();
            Ok(PointSummary { biases, ..row })
        };
        records.iter().map(row).collect()
    }

    /// The table of the verified points.
    pub(crate) fn table(&self) -> drillsweep_table::Table {
        verification::verification(&self.points, &self.findings)
    }
}

/// What verifying a sample of the points has shown
///
/// One row a point that the request's `verify` has chosen: `ordinal`, its parameters, the `state` of the reference run, and for each
/// statistic NAME (orbit sizes, standard deviations of the radius, mean radii, frequencies of the strongest lines; of ensembles the
/// means over the members) the point's value, that of the reference as `reference_NAME`, and the bias as `bias_NAME`: relative to
/// the reference, of frequencies in Hz. The attribute `statistics` sums them up by NAME: how many points are `verified`, the `mean`
/// bias with its 95 % `interval`, the `largest` with the point that has it (`largest_at`), and what the sweep's accuracy has
/// `promised`, with the number of points `exceeding` it; `warnings` says the latter in words. A sweep that verifies nothing has no rows.
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
    Query(TableQuery { format, fields }): Query<TableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let format = Format::choose(format, &headers)?;
    if app.store.sweep_version(&id).await?.is_none() {
        return Err(records::no_such_sweep(&id));
    }
    let verified = Verified::load(&app.store, &id).await?;
    let place = app.view(verified.points.len() as u64 * MEMORY_OF_POINT).await?;
    place
        .answer(move || {
            let name = format!("sweep-{id}-verification");
            Answer::of_table(verified.table(), fields.as_deref(), format, &name)
        })
        .await
}
