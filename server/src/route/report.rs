//! Printable reports of sweeps and points.

use axum::Extension;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use drillsweep_api::judgement::{LimitChanges, OperatingLimits};
use drillsweep_api::view::node;
use drillsweep_api::view::operating_window::OperatingWindow;
use drillsweep_api::view::orbit;
use drillsweep_api::{PointState, Sweep};
use drillsweep_chart::Hole;
use drillsweep_quantity::columns::*;
use drillsweep_quantity::{Quantity, UnitSystem};
use drillsweep_report::{self as report, FailedPoint, MOST_FAILURES, PointData, SweepData, WindowData};
use drillsweep_store::SweepRecord;
use drillsweep_table::{Table, tables};
use indexmap::IndexMap;
use serde::Deserialize;
use tokio::runtime::Handle;

use crate::answer::error::Result;
use crate::answer::etag::Tag;
use crate::answer::extract::{Path, Query, value};
use crate::answer::recordings::{self, Recording};
use crate::answer::records;
use crate::answer::snapshots::Snapshots;
use crate::answer::stored::Stored;
use crate::app::App;
use crate::guard::caller::Caller;
use crate::openapi::answers::{Conditional, Problems};
use crate::route::analysis;
use crate::route::results::{PointPath, file_name, rows_of_extremes};
use crate::route::verification::{Verified, memory_of_points};

/// Points of an orbit, and of the rotation over time, that a report draws, at most.
const MOST_DRAWN: usize = 4000;

/// Memory of a report with its pictures \[bytes\].
const MEMORY_OF_REPORT: u64 = 4 << 20;

/// Measured depth below any string \[m\].
const BELOW: f64 = 1e6;

/// Formats of reports.
#[derive(Debug, Clone, Copy, Default, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ReportFormat {
    /// A self-contained HTML document without scripts.
    #[default]
    Html,
}

/// Query of a report.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct ReportQuery {
    /// Format of the report.
    #[serde(default)]
    #[param(inline)]
    format: ReportFormat,
    /// Units of values and pictures.
    #[serde(default)]
    #[param(inline)]
    units: UnitSystem,
    /// Changes of the service's limits: `COLUMN:VALUE` in the column's unit or with a unit, or `COLUMN:off`, separated by commas.
    #[serde(default, deserialize_with = "value::limits")]
    #[param(value_type = Option<String>, example = "bit_stick_slip_severity:0.5,largest_side_force:20000")]
    limits: LimitChanges,
}

/// Report of a sweep, to print
///
/// Two to four pages A4: inputs, string, operating window with the limits in use, worst places, motion of the worst point, accuracy,
/// failures, physics version and key. Sentences of findings are in the units of `GET .../diagnosis`.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/report",
    tag = "sweeps",
    operation_id = "get_sweep_report",
    params(("id" = String, Path, description = "Identifier of the sweep"), ReportQuery, Conditional),
    responses((status = 200, description = "The report", body = String, content_type = "text/html"), (status = 304, description = "The copy is current"), Problems)
)]
pub(crate) async fn of_sweep(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(id): Path<String>,
    Query(query): Query<ReportQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let limits = app.config.operating_limits.with(&query.limits);
    let record = sweep(&app, &id).await?;
    let tag =
        Tag::of("sweep report", &(&id, record.version, &record.name, &record.tags_json, &query, &limits));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let ReportQuery { format: ReportFormat::Html, units, .. } = query;
    let verified = Verified::load(&app.store, &id).await?;
    let memory = memory_of_points(&app, &id, record.counts.total.unsigned_abs()).await?;
    let place = app.view(memory + MEMORY_OF_REPORT).await?;
    let (runtime, store) = (Handle::current(), app.store.clone());
    let (of_sweep, by) = (id.clone(), limits.clone());
    let (window, verified) = place
        .run(move || {
            let mut window = OperatingWindow::new(by.clone());
            let mut failures = Vec::new();
            verified.each_point(&store, &of_sweep, &runtime, |point| {
                if let (Some(error), true) = (&point.error, failures.len() < MOST_FAILURES) {
                    failures.push(FailedPoint { ordinal: point.ordinal, error: error.clone() });
                }
                window.push(&point)
            })?;
            Ok((WindowData::new(window, by, &verified.findings, failures, units), verified))
        })
        .await?;
    let worst = window.worst_point().unwrap_or(1);
    let sources = Sources::load(&app, &caller, &id, worst, &limits, &verified).await?;
    let sweep = records::sweep(&record)?;
    let place = app.view(sources.memory().await? + MEMORY_OF_REPORT).await?;
    let write = move || {
        let data = SweepData { sweep, window, findings: verified.findings, point: sources.read()? };
        Ok(report::sweep(&data, units))
    };
    let html = place.run(write).await?;
    Ok(response(html, &format!("sweep-{id}-report"), &tag))
}

/// Report of a point, to print
///
/// Two to four pages A4: judgement with evidence, inputs, string, worst places with depths and times, orbit, rotation of the bit, loads along
/// the string, accuracy, physics version and key. Sentences of findings are in the units of `GET .../diagnosis`.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/report",
    tag = "points",
    operation_id = "get_point_report",
    params(PointPath, ReportQuery, Conditional),
    responses((status = 200, description = "The report", body = String, content_type = "text/html"), (status = 304, description = "The copy is current"), Problems)
)]
pub(crate) async fn of_point(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<ReportQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let limits = app.config.operating_limits.with(&query.limits);
    let record = sweep(&app, &id).await?;
    let point = analysis::point(&app, &id, n).await?;
    // The version of the sweep changes with its points and reference runs.
    let tag =
        Tag::of("point report", &(&point, record.version, &record.name, &record.tags_json, &query, &limits));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let ReportQuery { format: ReportFormat::Html, units, .. } = query;
    let verified = Verified::load(&app.store, &id).await?;
    let sources = Sources::load(&app, &caller, &id, n, &limits, &verified).await?;
    let sweep: Sweep = records::sweep(&record)?;
    let place = app.view(sources.memory().await? + MEMORY_OF_REPORT).await?;
    let html = place.run(move || Ok(report::point(&sweep, &sources.read()?, units))).await?;
    Ok(response(html, &file_name(&id, n, "report"), &tag))
}

async fn sweep(app: &App, id: &str) -> Result<SweepRecord> {
    app.store.sweep(id).await?.ok_or_else(|| records::no_such_sweep(id))
}

fn response(html: String, name: &str, tag: &Tag) -> Response {
    let mut response = tag.on(html.into_response());
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8"));
    headers.insert(header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY"));
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    let policy = format!("{}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'", report::POLICY);
    let disposition = format!("inline; filename=\"{name}.html\"");
    for (name, text) in
        [(header::CONTENT_SECURITY_POLICY, policy), (header::CONTENT_DISPOSITION, disposition)]
    {
        if let Ok(value) = text.parse() {
            headers.insert(name, value);
        }
    }
    response
}

/// Sources of a point's part of a report: records, and stored tables as far as the result has them.
struct Sources {
    data: PointData,
    recording: Option<Recording>,
    snapshots: Option<Snapshots>,
    loads: Option<Stored>,
}

impl Sources {
    async fn load(
        app: &App,
        caller: &Caller,
        id: &str,
        n: u32,
        limits: &OperatingLimits,
        verified: &Verified,
    ) -> Result<Self> {
        let point = analysis::point(app, id, n).await?;
        let has_diagnosis = point.summary.is_some() || point.row.state == PointState::Failed;
        let diagnosis = match has_diagnosis {
            true => Some(analysis::diagnose(app, caller, id, point.clone(), limits).await?),
            false => None,
        };
        let biases = verified.points.iter().find(|point| point.ordinal == n);
        let biases = biases.map_or_else(IndexMap::new, |point| point.biases());
        let has_result = point.summary.is_some();
        let data = PointData { point, diagnosis, biases, orbit: None, rotation: None, loads: None };
        let mut sources = Self { data, recording: None, snapshots: None, loads: None };
        if has_result {
            let key = recordings::result_key(&app.store, id, n).await?;
            let artifacts = app.store.artifacts(&key).await?;
            // Without tables that have expired, a report is shorter.
            let stored = artifacts.into_iter().filter_map(|artifact| {
                let name = artifact.name.clone();
                Some((name, Stored::new(&app.store, &key, artifact).ok()?))
            });
            let mut by_name: IndexMap<String, Stored> = stored.collect();
            let mut take = |name: &str| by_name.swap_remove(name);
            sources.loads = take(tables::LOADS.name);
            if let (Some(history), Some(statics)) = (take(tables::HISTORY.name), take(tables::STATICS.name)) {
                let snapshots = take(tables::SNAPSHOTS.name);
                sources.snapshots = snapshots.map(|stored| Snapshots::new(stored, &statics)).transpose()?;
                let string = sources.data.point.scenario.string.clone();
                sources.recording = Some(Recording { history, statics, string });
            }
        }
        Ok(sources)
    }

    /// Memory for reading the tables \[bytes\].
    async fn memory(&self) -> Result<u64> {
        let mut memory = 0;
        if let Some(recording) = &self.recording {
            memory += recording.memory_of_orbit().await?;
        }
        for stored in self.loads.iter().chain(self.snapshots.as_ref().map(Snapshots::stored)) {
            memory += stored.memory().await?;
        }
        Ok(memory)
    }

    /// The data with the tables, of which nothing is larger than a picture needs. Blocks.
    fn read(mut self) -> Result<PointData> {
        if let Some(recording) = self.recording.take() {
            self.data.orbit = Some(self.orbit(&recording)?);
            self.data.rotation = self.rotation(&recording)?;
        }
        self.data.loads = self.loads.map(|loads| loads.read(None)).transpose()?;
        Ok(self.data)
    }

    fn number(&self, quantity: &Quantity) -> Option<f64> {
        self.data.point.summary.as_ref()?.get(quantity.name)?.as_f64()
    }

    /// Window of the statistics \[s\].
    fn window(&self) -> [Option<f64>; 2] {
        [&STATISTICS_FROM, &STATISTICS_TO].map(|end| self.number(end))
    }

    /// The path of the recorded node nearest to the largest orbit.
    fn orbit(&self, recording: &Recording) -> Result<(Table, Hole)> {
        let node = node::Choice::Nearest(self.number(&LARGEST_ORBIT_SIZE_DEPTH).unwrap_or(BELOW));
        let [from, to] = self.window();
        // A result may keep another window of its history.
        let motion =
            recording.motion_of(node, from, to).or_else(|_| recording.motion_of(node, None, None))?;
        let table = motion.label(orbit::orbit(&motion.columns(), None, None, Some(MOST_DRAWN)));
        Ok((table, recording.hole_at(motion.node)?))
    }

    /// The rotation of the lowest node: of its history, or else of the snapshots.
    fn rotation(&self, recording: &Recording) -> Result<Option<(Table, String)>> {
        let Some((node, _)) = recording.lowest_node()? else { return Ok(None) };
        let history = recording.history.open()?;
        let column = ROTATION_SPEED.at_node(node as usize);
        if history.layout().columns.contains_key(&column) {
            let layout = history.layout().select(&[TIME.name.to_owned(), column.clone()]);
            let Ok(layout) = layout else { return Ok(None) };
            let rows = history.rows();
            let part = history.cut(layout, 0..rows, 1)?;
            let table = rows_of_extremes(&recording.history, &part, MOST_DRAWN)?;
            return Ok(Some((table.widened(), column)));
        }
        let Some(snapshots) = &self.snapshots else { return Ok(None) };
        let table = snapshots.of_lowest_node(&[ROTATION_SPEED.name], [None, None], MOST_DRAWN)?;
        Ok(table.map(|table| (table, ROTATION_SPEED.name.to_owned())))
    }
}
