//! Spectrogram of a node's orbit.

use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use drillsweep_api::view::spectrogram::{MOST_AMPLITUDES, SpectrogramRequest, spectrogram};
use drillsweep_api::view::{node, spectrum};
use drillsweep_quantity::UnitChoice;
use serde::{Deserialize, Deserializer};

use crate::answer::error::Result;
use crate::answer::etag::Tag;
use crate::answer::extract::{Path, Query, value};
use crate::answer::format::{Answer, Form, TableFormat};
use crate::answer::recordings::Recording;
use crate::answer::records;
use crate::app::App;
use crate::openapi::answers::{Conditional, Problems, TableResponse};
use crate::route::results::{PointPath, check_window, file_name};

/// Query of a spectrogram.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct SpectrogramQuery {
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
    /// Start of the analysed part \[s\], included.
    #[serde(default, deserialize_with = "value::number")]
    from: Option<f64>,
    /// End of the analysed part \[s\], not included.
    #[serde(default, deserialize_with = "value::number")]
    to: Option<f64>,
    /// Length of each window \[s\]; absent means 4 s, or a quarter of the whole if that is shorter. The resolution in frequency is 1 over
    /// it.
    #[serde(default, deserialize_with = "length")]
    #[param(exclusive_minimum = 0.0)]
    window_s: Option<f64>,
    /// Distance between the beginnings of windows \[s\]; absent means an eighth of a window, or more if there would be over 200 windows.
    #[serde(default, deserialize_with = "length")]
    #[param(exclusive_minimum = 0.0)]
    step_s: Option<f64>,
    /// Weighting of the samples in each window.
    #[serde(default = "hann")]
    #[param(inline, default = "hann")]
    window: spectrum::Weighting,
    /// Frequencies from minus to plus this \[Hz\] are shown.
    #[serde(default = "usual_range", deserialize_with = "range")]
    #[param(default = 20.0, exclusive_minimum = 0.0)]
    range_hz: f64,
    /// Format of the table; absent means that `Accept` decides.
    #[param(inline)]
    format: Option<TableFormat>,
    /// Units of the columns: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, or a quantity at all nodes,
    /// separated by commas. Attributes follow; CSV then has units in its first line. Absent means the kept units.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,mud_density:kg/m3")]
    units: Option<UnitChoice>,
}

fn hann() -> spectrum::Weighting {
    spectrum::Weighting::Hann
}

fn usual_range() -> f64 {
    20.0
}

fn range<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    length(deserializer)?.ok_or_else(|| serde::de::Error::custom("must be a number greater than 0"))
}

fn length<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    match value::number(deserializer)? {
        Some(length) if length <= 0.0 => Err(serde::de::Error::custom("must be a number greater than 0")),
        length => Ok(length),
    }
}

/// Full spectrum of a node's orbit over time
///
/// Spectra, as of `spectrum`, of successive windows of the recorded motion: window after window, each ascending in frequency; positive
/// frequencies are forward whirl, negative ones backward. The time is the middle of the window. Attributes: `node`, `measured_depth`,
/// `windows`, `samples` of each, `window_s` and `step_s` as used, `resolution` \[Hz\], `window`, and `resolved_hz`, the frequency up to
/// which the run's steps resolve vibrations. It has at most 1,000,000 amplitudes.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/spectrogram",
    tag = "points",
    operation_id = "get_spectrogram",
    params(PointPath, SpectrogramQuery, Conditional),
    responses(TableResponse, Problems)
)]
pub(crate) async fn show(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(query): Query<SpectrogramQuery>,
    headers: HeaderMap,
) -> Result<Response> {
    /// Bytes of an amplitude with time and frequency, in memory and in writing.
    const OF_AMPLITUDE: u64 = 64;
    let form = Form::choose(query.format, query.units.clone(), &headers)?;
    check_window(query.from, query.to)?;
    let choice = node::Choice::from_parameters(query.node, query.depth, query.nearest)?;
    let recording = Recording::load(&app.store, &id, n).await?;
    let point = app.store.point(&id, n.into()).await?;
    let resolved_hz = point.as_ref().map(records::resolved_hz).transpose()?.flatten();
    let tag = Tag::of(&form, &(recording.blobs(), &query, resolved_hz));
    if let Some(unchanged) = tag.unchanged(&headers) {
        return Ok(unchanged);
    }
    let reading = recording.memory_of_orbit().await? + MOST_AMPLITUDES as u64 * OF_AMPLITUDE;
    let place = app.view(form.format.memory(reading)).await?;
    place
        .answer(move || {
            let SpectrogramQuery { from, to, window_s, step_s, window, range_hz, .. } = query;
            let motion = recording.motion_of(choice, from, to)?;
            let request =
                SpectrogramRequest { weighting: window, window: window_s, step: step_s, range: range_hz };
            let table = motion.label(spectrogram(&motion.columns(), &request)?);
            let table = spectrum::mark_resolved(table, resolved_hz);
            let file_name = file_name(&id, n, &format!("spectrogram-{}", motion.node));
            Answer::of_table(table, None, form, &file_name, Some(tag))
        })
        .await
}
