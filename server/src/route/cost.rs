//! Work-precision study of a point, as numbers, lines or charts.

use axum::extract::State;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use drillsweep_api::cost::{CostReport, Measure, table};
use drillsweep_api::in_units::InUnits;
use drillsweep_chart::{PNG_WIDTH, work_precision};
use drillsweep_quantity::UnitChoice;
use drillsweep_table::csv;
use serde::Deserialize;

use crate::answer::blocking::blocking;
use crate::answer::error::{Error, Result};
use crate::answer::extract::{Path, Query, value};
use crate::answer::recordings;
use crate::app::App;
use crate::openapi::answers::Problems;
use crate::route::results::PointPath;

/// Query of a study.
#[derive(Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct CostQuery {
    /// Format of the answer.
    #[serde(default)]
    #[param(inline)]
    format: CostFormat,
    /// Error that a chart shows; absent means the first of orbit size, radius deviation and trajectory that is known.
    #[param(inline)]
    measure: Option<Measure>,
    /// Units of depths and values in JSON: `si` (with prefixes) or `field` (the oil field's), and `COLUMN:UNIT` for single columns, separated by commas; a member `units` of
    /// the answer then names them. Absent means the kept units. Other formats have ratios and times alone.
    #[serde(default, deserialize_with = "value::units")]
    #[param(value_type = Option<String>, example = "field,orbit_radius_rms:mm")]
    units: Option<UnitChoice>,
}

/// Formats of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
enum CostFormat {
    /// The full report.
    #[default]
    Json,
    /// One line a run.
    Csv,
    /// The chart as SVG.
    Svg,
    /// The chart as PNG.
    Png,
}

impl CostFormat {
    fn media_type(self) -> &'static str {
        match self {
            CostFormat::Json => "application/json",
            CostFormat::Csv => "text/csv",
            CostFormat::Svg => "image/svg+xml",
            CostFormat::Png => "image/png",
        }
    }
}

/// Cost of accuracy: a point's work-precision study
///
/// Exists for points whose scenario has a `cost_study`: errors and processor times of accuracies, methods, steps and meshes, relative to a
/// reference on which two independent methods agree, and the cheapest way to some accuracies. If the two do not agree, it reports that no
/// reference exists.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/points/{n}/cost",
    tag = "points",
    operation_id = "get_cost",
    params(PointPath, CostQuery),
    responses(
        (status = 200, description = "The study", content(
            (CostReport = "application/json"),
            (String = "text/csv"),
            (String = "image/svg+xml"),
            (Vec<u8> = "image/png")
        )),
        Problems
    )
)]
pub(crate) async fn show(
    State(app): State<App>,
    Path(PointPath { id, n }): Path<PointPath>,
    Query(CostQuery { format, measure, units }): Query<CostQuery>,
) -> Result<Response> {
    let stored = recordings::stored(&app.store, &id, n, "cost").await?.whole().await?;
    let units = units.unwrap_or_default();
    if format == CostFormat::Json && units.is_kept() {
        return Ok(answer(stored.into(), format));
    }
    blocking(move || {
        let report: CostReport = serde_json::from_slice(&stored).map_err(|error| Error::internal(&error))?;
        if report.compared().next().is_none() && matches!(format, CostFormat::Svg | CostFormat::Png) {
            let detail = "must be json or csv: a study of effects has no chart";
            return Err(Error::parameter("format", None, detail));
        }
        let drawing = || work_precision(&report, measure.unwrap_or_else(|| Measure::usual(&report)));
        let body = match format {
            CostFormat::Json => {
                serde_json::to_vec(&InUnits::new(report, &units)).map_err(|error| Error::internal(&error))?
            }
            CostFormat::Csv => {
                csv::write(&table([&report])).map_err(|error| Error::internal(&error))?.into_bytes()
            }
            CostFormat::Svg => drawing().svg().into_bytes(),
            CostFormat::Png => drawing().png(PNG_WIDTH).map_err(|error| Error::internal(&error))?,
        };
        Ok(answer(body, format))
    })
    .await
}

fn answer(body: Vec<u8>, format: CostFormat) -> Response {
    let media_type = HeaderValue::from_static(format.media_type());
    ([(header::CONTENT_TYPE, media_type)], body).into_response()
}
