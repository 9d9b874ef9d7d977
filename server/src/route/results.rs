//! Tables of a point's result, and views of them.

use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::Response;
use drillsweep_api::view::history::{self, Decimation, Extremes};
use drillsweep_api::view::{node, orbit, spectrum};
use drillsweep_chart as chart;
use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::{ROTATION_SPEED, TORQUE};
use drillsweep_store::Store;
use drillsweep_table::parquet::Cut;
use drillsweep_table::tables::{self, Layout};
use drillsweep_table::{Source as _, Table};
use indexmap::IndexMap;
use serde::{Deserialize, Deserializer};

use crate::answer::error::{Error, Result};
use crate::answer::etag::Tag;
use crate::answer::extract::{Path, Query, value};
use crate::answer::format::{self, Answer, Form, Format, Head, PictureFormat, TableFormat};
use crate::answer::need::Need;
use crate::answer::recordings::{self, Recording, Samples, SpectrumSource, mark_cut, title_of_cut};
use crate::answer::records;
use crate::answer::snapshots::Snapshots;
use crate::answer::stored::{Stored, StoredFile};
use crate::app::App;
use crate::openapi::answers::{Conditional, PictureResponse, Problems, TableResponse};

/// Path of a point.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Path)]
pub(crate) struct PointPath {
    /// Identifier of the sweep.
    pub(crate) id: String,
    /// Number of the point in the sweep, from 1.
    #[param(minimum = 1)]
    pub(crate) n: u32,
}

/// Query of a table.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct TableQuery {
    /// Format of the table; absent means that `Accept` decides.
    #[param(inline)]
    pub(crate) format: Option<TableFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, or a quantity at all nodes,
    /// separated by commas. Attributes follow; CSV then has units in its first line. Absent means the kept units.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,mud_density:kg/m3")]
    pub(crate) units: Option<UnitChoice>,
    /// Only these columns, separated by commas.
    #[serde(default, deserialize_with = "value::names")]
    #[param(value_type = Option<String>)]
    pub(crate) fields: Option<Vec<String>>,
}

/// Query of a table that can be drawn as a picture.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct PictureQuery {
    /// Format of the table, or of its picture; absent means that `Accept` decides.
    #[param(inline)]
    pub(crate) format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, or a quantity at all nodes,
    /// separated by commas. Attributes follow; CSV then has units in its first line. Absent means the kept units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,mud_density:kg/m3")]
    pub(crate) units: Option<UnitChoice>,
    /// Only these columns, separated by commas; of a picture, the columns that it shows.
    #[serde(default, deserialize_with = "value::names")]
    #[param(value_type = Option<String>)]
    pub(crate) fields: Option<Vec<String>>,
}

/// Geometry, hydraulics and forces of every element
///
/// Eccentricity, friction coefficient C_f, apparent viscosity, flow regime, pressures, tension and torque at
/// the equilibrium, from the top down. A picture shows C_f, or the `fields`, over depth.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/profile",
    tag = "points",
    operation_id = "get_profile",
    params(PointPath, PictureQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn profile(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(PictureQuery { format, units, fields }): Query<PictureQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(format, units, &headers)?;
    let profile = recordings::stored(&app.store, &id, n, tables::PROFILE.name).await?;
    let file_name = file_name(&id, n, tables::PROFILE.name);
    if !form.format.is_picture() {
        return part(&app, profile, fields, form, file_name, &headers).await;
    }
    let title = caption(&app.store, &id, n, "Profile", &form.units).await?;
    let tag = Tag::of(&form, &(profile.blob(), &fields, &title));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let memory = form.format.memory(profile.memory().await?);
    let key = format!("{} {id}/{n}", tag.as_str());
    app.answer(form.format, &key, memory, move || {
        let table = profile.read(None)?;
        let draw =
            |table: &Table, units: &UnitChoice| chart::profile(table, fields.as_deref(), &title, units);
        Answer::of_table_or_picture(table, None, form, &file_name, Some(tag), draw)
    })
    .await
}

/// Static equilibrium, node by node
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/statics",
    tag = "points",
    operation_id = "get_statics",
    params(PointPath, TableQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn statics(
    app: State<App>,
    path: Path<PointPath>,
    query: Query<TableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    whole_table(&tables::STATICS, app, path, query, headers).await
}

/// Strongest spectral lines of the recorded nodes
///
/// A row a line, the strongest first, for each node and spectrum window in turn, with Hann's weights; `GET .../diagnosis` names their causes.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/lines",
    tag = "points",
    operation_id = "get_lines",
    params(PointPath, TableQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn lines(
    app: State<App>,
    path: Path<PointPath>,
    query: Query<TableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    whole_table(&tables::LINES, app, path, query, headers).await
}

/// Contacts of every node with the hole over the run
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/contacts",
    tag = "points",
    operation_id = "get_contacts",
    params(PointPath, TableQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn contacts(
    app: State<App>,
    path: Path<PointPath>,
    query: Query<TableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    whole_table(&tables::CONTACTS, app, path, query, headers).await
}

/// Loads of every node over the window of the statistics
///
/// Accelerations in m/s2 (lateral, axial, by torsion, and as a tool that turns with the string reads them), shocks, rotation speed
/// with stick-slip severity and stick share, whirl, action of the wall, and bending, tension, torque and equivalent stress of the element above
/// the node. Means and extremes are of the ends of all steps, not of recorded samples.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/loads",
    tag = "points",
    operation_id = "get_loads",
    params(PointPath, TableQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn loads(
    app: State<App>,
    path: Path<PointPath>,
    query: Query<TableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    whole_table(&tables::LOADS, app, path, query, headers).await
}

/// Energy ledger over the run
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/energy",
    tag = "points",
    operation_id = "get_energy",
    params(PointPath, TableQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn energy(
    app: State<App>,
    path: Path<PointPath>,
    query: Query<TableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    whole_table(&tables::ENERGY, app, path, query, headers).await
}

/// Motion over the whole of a run that ends once it has settled, at 20 Hz at most
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/course",
    tag = "points",
    operation_id = "get_course",
    params(PointPath, TableQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn course(
    app: State<App>,
    path: Path<PointPath>,
    query: Query<TableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    whole_table(&tables::COURSE, app, path, query, headers).await
}

/// A stored table; Parquet is sent without conversion.
async fn whole_table(
    &Layout { name, .. }: &Layout,
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<TableQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(query.format, query.units, &headers)?;
    let table = recordings::stored(&app.store, &id, n, name).await?;
    part(&app, table, query.fields, form, file_name(&id, n, name), &headers).await
}

/// A stored table, or some columns of it, in a form other than a picture; Parquet in kept units is sent without conversion.
async fn part(
    app: &App,
    stored: Stored,
    fields: Option<Vec<String>>,
    form: Form,
    file_name: String,
    headers: &HeaderMap,
) -> Result<Response> {
    if form.is_stored() && fields.is_none() {
        return whole_file(app, stored, &file_name, headers).await;
    }
    let tag = Tag::of(&form, &(stored.blob(), &fields));
    if let Some(unchanged) = tag.unchanged(headers) {
        return Ok(unchanged);
    }
    let place = app.view(Need::of(&stored, form.format, fields.as_deref()).await?).await?;
    place
        .answer(move || {
            let table = stored.open()?;
            let layout = format::select(table.layout().clone(), fields.as_deref())?;
            let cut = table.cut(layout, 0..usize::MAX, 1)?;
            Ok(Answer::of_part(stored, cut, form, &file_name, tag))
        })
        .await
}

/// A stored table as Parquet.
pub(super) async fn whole_file(
    app: &App,
    stored: Stored,
    file_name: &str,
    headers: &HeaderMap,
) -> Result<Response> {
    let form = Form::from(Format::Parquet);
    let tag = Tag::of(&form, &stored.blob());
    if let Some(unchanged) = tag.unchanged(headers) {
        return Ok(unchanged);
    }
    let head = Head::new(form, file_name, tag);
    let length = stored.length();
    let mut response = head.response(stored.body(0..length, app.file()).await?);
    response.headers_mut().insert(header::CONTENT_LENGTH, length.into());
    Ok(response)
}

/// Query of recorded histories.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct HistoryQuery {
    /// A recorded node, 1 at the top; absent, like `depth`, means all of them.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1)]
    node: Option<u32>,
    /// Measured depth \[m\] of a recorded node, to within half an element.
    #[serde(default, deserialize_with = "value::number")]
    depth: Option<f64>,
    /// Take the recorded node nearest to `depth`, however far.
    #[serde(default, deserialize_with = "value::truth")]
    nearest: bool,
    /// Start of the window \[s\], included.
    #[serde(default, deserialize_with = "value::number")]
    from: Option<f64>,
    /// End of the window \[s\], not included. A window that ends after the history is cut there (attribute `window_cut_at`).
    #[serde(default, deserialize_with = "value::number")]
    to: Option<f64>,
    /// Largest number of rows, which `decimation` chooses. Absent means all.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1)]
    max_points: Option<u32>,
    /// Choice of rows beyond `max_points`. `minmax` keeps at least two for each column except `time`.
    #[serde(default)]
    #[param(inline)]
    decimation: Decimation,
    /// Format of the table, or of its picture; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, or a quantity at all nodes,
    /// separated by commas. Attributes follow; CSV then has units in its first line. Absent means the kept units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,mud_density:kg/m3")]
    units: Option<UnitChoice>,
    /// Only these columns, separated by commas; of a picture, the columns that it shows.
    #[serde(default, deserialize_with = "value::names")]
    #[param(value_type = Option<String>)]
    fields: Option<Vec<String>>,
}

impl HistoryQuery {
    fn is_whole(&self) -> bool {
        self.node.is_none()
            && self.depth.is_none()
            && !self.nearest
            && self.from.is_none()
            && self.to.is_none()
            && self.max_points.is_none()
            && self.fields.is_none()
    }
}

/// Recorded motion of the recorded nodes
///
/// Columns `time` and, for each node N, `u_N`, `v_N`, `w_N`, `theta_z_N` and their rates `u_rate_N`, ...; if torsion is solved for also
/// `rotation_speed_N`, the sum of the imposed rotation and the rate of twist \[rad/s\], and `torque_N`, the torque in the element above the
/// node, of the first node in that below it \[N m\], negative if it opposes clockwise rotation. These two exist for the bit as well. A
/// picture shows u and v; with torsion also rotation speed \[rpm\] and torque at the bit, from the history or else the snapshots, or, as
/// its text then states, of the lowest recorded node. For a chosen node it shows the columns of that node, and with `fields` those alone.
/// The legend gives depths, names of components and directions. A picture shows at most 2,000,000 values.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/history",
    tag = "points",
    operation_id = "get_history",
    params(PointPath, HistoryQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn history(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<HistoryQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    let format = form.format;
    check_window(query.from, query.to)?;
    let choice = match (query.node, query.depth) {
        (None, None) if !query.nearest => None,
        (node, depth) => Some(node::Choice::from_parameters(node, depth, query.nearest)?),
    };
    let file_name = file_name(&id, n, tables::HISTORY.name);
    let recording = Recording::load(&app.store, &id, n).await?;
    if form.is_stored() && query.is_whole() {
        return whole_file(&app, recording.history, &file_name, &headers).await;
    }
    let title = caption(&app.store, &id, n, "History", &form.units).await?;
    let shows_bit = format.is_picture() && choice.is_none() && query.fields.is_none();
    let snapshots = match shows_bit {
        true => recordings::stored_if_any(&app.store, &id, n, tables::SNAPSHOTS.name).await?,
        false => None,
    };
    let snapshots = snapshots.map(|stored| Snapshots::new(stored, &recording.statics)).transpose()?;
    let blob_of_snapshots = snapshots.as_ref().map(|snapshots| snapshots.stored().blob());
    let tag = Tag::of(&form, &(recording.blobs(), blob_of_snapshots, &query, &title));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let reading_snapshots = match &snapshots {
        Some(snapshots) => {
            let shown = snapshots.count().min(MOST_SNAPSHOTS_SHOWN) * COLUMNS_OF_BIT;
            snapshots.stored().memory().await? + shown as u64 * MEMORY_OF_SHOWN
        }
        None => 0,
    };
    let drawing = if format.is_picture() { MOST_SHOWN as u64 * MEMORY_OF_SHOWN } else { 0 };
    let kept = match query.decimation {
        Decimation::Stride => 0,
        Decimation::Minmax => memory_of_rows(&recording.history, query.max_points),
    };
    let fields = query.fields.as_deref().filter(|_| !format.is_picture());
    let mut need = Need::of(&recording.history, format, fields).await?;
    need.bytes += if format == Format::Parquet { 3 * kept } else { reading_snapshots + drawing + kept };
    let key = format!("{} {id}/{n}", tag.as_str());
    app.answer(format, &key, need, move || {
        let history = recording.history.open()?;
        let layout = match choice {
            None => history.layout().clone(),
            Some(choice) => recording.layout_of(choice, history.layout().clone())?,
        };
        let Samples { rows: samples, cut_at } = recording.samples(&history, query.from, query.to)?;
        let most = query.max_points.map(|points| points as usize);
        let extremes = most.filter(|most| query.decimation == Decimation::Minmax && *most < samples.len());
        let stride = if extremes.is_some() { 1 } else { history::stride(samples.len(), most) };
        let layout = mark_cut(layout.attribute("samples", samples.len()), cut_at);
        if !format.is_picture() {
            let layout = format::select(layout, query.fields.as_deref())?;
            let part = history.cut(layout, samples, stride)?;
            if let Some(most) = extremes {
                let table = rows_of_extremes(&recording.history, &part, most)?;
                return Answer::of_table(table, None, form, &file_name, Some(tag));
            }
            return Ok(Answer::of_part(recording.history, part, form, &file_name, tag));
        }
        let layout = chart::shown_of_history(&layout, query.fields.as_deref())?;
        let columns = layout.columns.len();
        let part = history.cut(layout, samples, stride)?;
        let table = match extremes {
            Some(most) => {
                check_shown(most, columns)?;
                rows_of_extremes(&recording.history, &part, most)?
            }
            None => {
                check_shown(part.rows(), columns)?;
                part.read().map_err(|error| recording.history.problem(error))?
            }
        };
        let table = table.widened();
        let places = recording.places(&table)?;
        let bit = match shows_bit {
            true => bit(&recording, snapshots.as_ref(), [query.from, query.to], most)?,
            false => None,
        };
        let title = title_of_cut(&title, cut_at);
        let fields = query.fields.as_deref();
        let draw = |table: &Table, units: &UnitChoice| {
            chart::history(table, fields, &places, bit.as_ref(), &title, units)
        };
        Answer::of_table_or_picture(table, None, form, &file_name, Some(tag), draw)
    })
    .await
}

/// Lowest node of a recorded string, with its rotation from `snapshots` in a window.
fn bit(
    recording: &Recording,
    snapshots: Option<&Snapshots>,
    window: [Option<f64>; 2],
    most: Option<usize>,
) -> Result<Option<chart::Bit>> {
    let Some((node, measured_depth)) = recording.lowest_node()? else { return Ok(None) };
    let most = most.unwrap_or(MOST_SNAPSHOTS_SHOWN).min(MOST_SNAPSHOTS_SHOWN);
    let columns = [ROTATION_SPEED.name, TORQUE.name];
    let rotation = snapshots.map(|snapshots| snapshots.of_lowest_node(&columns, window, most)).transpose()?;
    Ok(Some(chart::Bit { node, measured_depth, snapshots: rotation.flatten() }))
}

/// Rows with the extremes of the columns of a part of a history.
pub(super) fn rows_of_extremes(history: &Stored, part: &Cut<StoredFile>, most: usize) -> Result<Table> {
    let fewest = Extremes::fewest(part.layout());
    if most < fewest {
        let detail = format!("with minmax must be {fewest} or more: two for each column besides time");
        return Err(Error::parameter("max_points", Some(&most.to_string()), detail));
    }
    let mut extremes = Extremes::new(part.layout(), part.rows(), most);
    for piece in part.by_rows() {
        extremes.add(piece.map_err(|error| history.problem(error))?.as_ref());
    }
    part.rows_at(&extremes.finish()).map_err(|error| history.problem(error))
}

/// Bound on the memory of rows of a history \[bytes\]; stored they usually take half of that.
fn memory_of_rows(history: &Stored, most: Option<u32>) -> u64 {
    let rows = most.map_or(0, u64::from).min(history.rows());
    2 * history.length() / history.rows().max(1) * rows
}

/// Largest number of values in a picture of a history.
const MOST_SHOWN: usize = 2_000_000;

/// Columns of a picture from the snapshots of the bit: time, rotation speed and torque.
const COLUMNS_OF_BIT: usize = 3;

/// Largest number of snapshots in a picture.
const MOST_SNAPSHOTS_SHOWN: usize = MOST_SHOWN / COLUMNS_OF_BIT;

/// Memory for drawing a value \[bytes\].
const MEMORY_OF_SHOWN: u64 = 64;

/// Refuses an illegible picture.
fn check_shown(rows: usize, columns: usize) -> Result<()> {
    let values = rows.saturating_mul(columns);
    if values <= MOST_SHOWN {
        return Ok(());
    }
    let detail = format!(
        "the picture would show {values} values, {rows} of each of {columns} columns, more than the limit of {MOST_SHOWN}: \
         request one node, fewer `fields`, a shorter window, or at most that many points"
    );
    Err(Error::parameter("max_points", None, detail))
}

/// Query of an orbit.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct OrbitQuery {
    /// A recorded node, 1 at the top; either this or `depth`.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1)]
    node: Option<u32>,
    /// Measured depth \[m\] of a recorded node, to within half an element.
    #[serde(default, deserialize_with = "value::number")]
    depth: Option<f64>,
    /// Take the recorded node nearest to `depth`, however far.
    #[serde(default, deserialize_with = "value::truth")]
    nearest: bool,
    /// Start of the window \[s\], included.
    #[serde(default, deserialize_with = "value::number")]
    from: Option<f64>,
    /// End of the window \[s\], not included. A window that ends after the history is cut there (attribute `window_cut_at`).
    #[serde(default, deserialize_with = "value::number")]
    to: Option<f64>,
    /// Largest number of points, from 4: those with the extremes of u and v in each part of the window. Absent means all.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 4)]
    max_points: Option<u32>,
    /// For a picture: true shows the motion alone, with the whole hole as an inset; absent means true if the motion is below a tenth of the
    /// hole.
    #[serde(default, deserialize_with = "value::choice")]
    zoom: Option<bool>,
    /// Format of the table, or of its picture; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, or a quantity at all nodes,
    /// separated by commas. Attributes follow; CSV then has units in its first line. Absent means the kept units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,mud_density:kg/m3")]
    units: Option<UnitChoice>,
}

/// Path of a node across the hole
///
/// Columns `time`, `u`, `v`, `radius` in the frame of the node; attributes `node`, `measured_depth`, `component`, if it has a name, and
/// `samples`, the number of samples in the window.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/orbit",
    tag = "points",
    operation_id = "get_orbit",
    params(PointPath, OrbitQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn orbit(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<OrbitQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    let format = form.format;
    check_window(query.from, query.to)?;
    let choice = node::Choice::from_parameters(query.node, query.depth, query.nearest)?;
    let max_points = query.max_points.map(|points| points as usize);
    if let Some(points) = max_points.filter(|points| *points < orbit::FEWEST_POINTS) {
        let detail = format!("must be {} or more", orbit::FEWEST_POINTS);
        return Err(Error::parameter("max_points", Some(&points.to_string()), detail));
    }
    let recording = Recording::load(&app.store, &id, n).await?;
    let title = caption(&app.store, &id, n, "Orbit", &form.units).await?;
    let tag = Tag::of(&form, &(recording.blobs(), &query, &title));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let memory = format.memory(recording.memory_of_orbit().await?);
    let key = format!("{} {id}/{n}", tag.as_str());
    app.answer(format, &key, memory, move || {
        let motion = recording.motion_of(choice, query.from, query.to)?;
        let table = motion.label(orbit::orbit(&motion.columns(), None, None, max_points));
        let hole = recording.hole_at(motion.node)?;
        let file_name = file_name(&id, n, &format!("orbit-{}", motion.node));
        let title = title_of_cut(&title, motion.cut_at);
        drop(motion);
        let draw = |table: &Table, units: &UnitChoice| chart::orbit(table, &hole, &title, query.zoom, units);
        Answer::of_table_or_picture(table, None, form, &file_name, Some(tag), draw)
    })
    .await
}

/// Query of a full spectrum.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpectrumQuery {
    /// A recorded node, 1 at the top; either this or `depth`.
    #[serde(default, deserialize_with = "value::count")]
    #[param(minimum = 1)]
    node: Option<u32>,
    /// Measured depth \[m\] of a recorded node, to within half an element.
    #[serde(default, deserialize_with = "value::number")]
    depth: Option<f64>,
    /// Take the recorded node nearest to `depth`, however far.
    #[serde(default, deserialize_with = "value::truth")]
    nearest: bool,
    /// Start of the window \[s\], included.
    #[serde(default, deserialize_with = "value::number")]
    from: Option<f64>,
    /// End of the window \[s\], not included. A window that ends after the history is cut there (attribute `window_cut_at`).
    #[serde(default, deserialize_with = "value::number")]
    to: Option<f64>,
    /// Weighting of the samples in the window.
    #[serde(default)]
    #[param(inline)]
    window: spectrum::Weighting,
    /// Frequencies from minus to plus this \[Hz\] are shown.
    #[serde(default = "default_range", deserialize_with = "range")]
    #[param(default = 20.0, exclusive_minimum = 0.0)]
    range_hz: f64,
    /// Largest number of listed peaks, the highest first.
    #[serde(default = "default_peaks", deserialize_with = "peaks")]
    #[param(default = 10)]
    peaks: usize,
    /// Format of the table, or of its picture; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<PictureFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, or a quantity at all nodes,
    /// separated by commas. Attributes follow; CSV then has units in its first line. Absent means the kept units, and SI with prefixes for a picture.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,mud_density:kg/m3")]
    units: Option<UnitChoice>,
}

fn default_range() -> f64 {
    20.0
}

fn default_peaks() -> usize {
    10
}

fn range<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let range = value::number(deserializer)?.filter(|range| *range > 0.0);
    range.ok_or_else(|| serde::de::Error::custom("must be a number greater than 0"))
}

fn peaks<'de, D: Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    let text = String::deserialize(deserializer)?;
    text.parse().map_err(|_| serde::de::Error::custom("must be a whole number, 0 or more"))
}

/// Full spectrum of a node's orbit
///
/// Spectrum of u + i v over a half-open window: positive frequencies are forward whirl, negative ones backward. Columns `frequency`,
/// `amplitude` (|Z|/N) and `peak_to_peak` (2|Z|/N); the attribute `peaks` lists the highest peaks with whirl direction, and frequency and
/// amplitude interpolated between bins. Neither has lines outside the range. The attribute `resolved_hz` is the frequency up to which the
/// run's steps resolve vibrations; peaks below it are `is_resolved`, and a picture shades the frequencies above. If a run kept only
/// spectra, the window is one of its scenario.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/spectrum",
    tag = "points",
    operation_id = "get_spectrum",
    params(PointPath, SpectrumQuery, Conditional),
    responses(PictureResponse, Problems)
)]
pub(crate) async fn spectrum(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<SpectrumQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    let format = form.format;
    check_window(query.from, query.to)?;
    let choice = node::Choice::from_parameters(query.node, query.depth, query.nearest)?;
    let source = SpectrumSource::load(&app.store, &id, n).await?;
    let title = caption(&app.store, &id, n, "Full spectrum", &form.units).await?;
    let point = app.store.point(&id, n.into()).await?;
    let resolved_hz = point.as_ref().map(records::resolved_hz).transpose()?.flatten();
    let tag = Tag::of(&form, &(source.blobs(), &query, &title, resolved_hz));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let memory = format.memory(source.memory().await?);
    let key = format!("{} {id}/{n}", tag.as_str());
    app.answer(format, &key, memory, move || {
        let SpectrumQuery { from, to, window, range_hz, peaks, .. } = query;
        let (node, table, cut_at) = match source {
            SpectrumSource::Recording(recording) => {
                let motion = recording.motion_of(choice, from, to)?;
                let table = spectrum::spectrum(&motion.columns(), window, range_hz, peaks)?;
                (motion.node, motion.label(table), motion.cut_at)
            }
            SpectrumSource::Kept(kept) => {
                let kept = kept.spectrum_of(choice, from, to, window)?;
                (kept.node, kept.label(spectrum::part(&kept.spectrum, range_hz, peaks)), None)
            }
        };
        let table = spectrum::mark_resolved(table, resolved_hz);
        let file_name = file_name(&id, n, &format!("spectrum-{node}"));
        let title = title_of_cut(&title, cut_at);
        let draw = |table: &Table, units: &UnitChoice| chart::spectrum(table, &title, units);
        Answer::of_table_or_picture(table, None, form, &file_name, Some(tag), draw)
    })
    .await
}

pub(crate) fn check_window(from: Option<f64>, to: Option<f64>) -> Result<()> {
    match (from, to) {
        (Some(from), Some(to)) if from >= to => {
            Err(Error::parameter("to", Some(&to.to_string()), format!("must be greater than from, {from}")))
        }
        _ => Ok(()),
    }
}

/// Title of a picture: its contents and point.
async fn caption(store: &Store, id: &str, n: u32, what: &str, units: &UnitChoice) -> Result<String> {
    let parameters = match store.point(id, n.into()).await? {
        Some(point) => records::parameters(&point.parameters_json)?,
        None => IndexMap::new(),
    };
    Ok(chart::caption(what, &parameters, units))
}

pub(crate) fn file_name(id: &str, n: u32, what: &str) -> String {
    format!("sweep-{id}-point-{n}-{what}")
}
