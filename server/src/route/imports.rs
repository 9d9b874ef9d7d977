//! Parts of a scenario from files of other programs; nothing is stored.

use axum::Extension;
use axum::extract::State;
use drillsweep_api::{FieldProblem, ProblemDetails, ProblemKind};
use drillsweep_import::{
    AssumedUnits, GridError, HoleImport, HoleOptions, ImportError, MOST_BYTES, MudAnswer, MudError,
    MudRequest, Survey, SurveyOptions, Tally, TallyLengths, TallyOptions, TallyOrder,
};
use serde::{Deserialize, Serialize};

use crate::answer::error::Result;
use crate::answer::extract::{self, File, Query};
use crate::answer::json::Json;
use crate::app::App;
use crate::app::expansions::Work;
use crate::guard::caller::Caller;
use crate::openapi::answers::Problems;

/// Bounds on the memory for reading a byte of a file, and a whole file \[bytes\]: a cell of at least two bytes takes 56, and so does an element
/// of XML; a workbook is compressed.
const MEMORY_OF_BYTE: usize = 32;
const MEMORY_OF_FILE: usize = 96 << 20;

/// Query of a survey.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct SurveyQuery {
    /// Unit of measured depth if the file has none, such as `ft`.
    depth_unit: Option<String>,
    /// Sheet of a workbook; absent means the first one.
    sheet: Option<String>,
}

/// Query of a tally.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct TallyQuery {
    /// Direction of the list; absent means that the bit decides.
    #[param(inline)]
    order: Option<TallyOrder>,
    /// Meaning of a length next to a number of joints; absent means that cumulative lengths decide.
    #[param(inline)]
    lengths: Option<TallyLengths>,
    /// Units of columns that have none: `si` (m, mm, kg/m) or `field` (ft, in, lb/ft); absent means that such columns are refused.
    #[param(inline)]
    assumed_units: Option<AssumedUnits>,
    /// Sheet of a workbook, the first one if absent; or name of the WITSML tubular, required if there are several.
    sheet: Option<String>,
}

/// Query of a hole.
#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[into_params(parameter_in = Query)]
#[serde(deny_unknown_fields)]
pub(crate) struct HoleQuery {
    /// Units of columns that have none: `si` (m, mm) or `field` (ft, in); absent means that such columns are refused.
    #[param(inline)]
    assumed_units: Option<AssumedUnits>,
    /// Sheet of a workbook, the first one if absent; or name of the WITSML geometry, required if there are several.
    sheet: Option<String>,
}

/// Read a survey of another program
///
/// CSV, Excel (`.xlsx`), LAS 2.0 or a WITSML 1.4.1.1 or 2.0 trajectory, with headings and units. The answer has the stations of `well.survey`, the
/// meaning of each column, and each cell that was left out. Nothing is stored.
#[utoipa::path(
    post,
    path = "/v1/imports/survey",
    tag = "imports",
    operation_id = "import_survey",
    params(SurveyQuery),
    request_body(content = Vec<u8>, content_type = "application/octet-stream", description = "Bytes of the file"),
    responses((status = 200, description = "The survey", body = Survey), Problems)
)]
pub(crate) async fn survey(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(SurveyQuery { depth_unit, sheet }): Query<SurveyQuery>,
    file: File<MOST_BYTES>,
) -> Result<Json<Survey>> {
    import(&app, &caller, file, move |bytes| {
        let options = SurveyOptions { depth_unit: depth_unit.as_deref(), sheet: sheet.as_deref() };
        drillsweep_import::survey(bytes, options)
    })
    .await
}

/// Read a tally of another program
///
/// CSV, Excel (`.xlsx`) or a WITSML 1.4.1.1 or 2.0 tubular, with headings and units. The answer has `string.sections` from the top down, the meaning of
/// each row and column, and each cell that could not be used. Nothing is stored.
#[utoipa::path(
    post,
    path = "/v1/imports/tally",
    tag = "imports",
    operation_id = "import_tally",
    params(TallyQuery),
    request_body(content = Vec<u8>, content_type = "application/octet-stream", description = "Bytes of the file"),
    responses((status = 200, description = "The tally", body = Tally), Problems)
)]
pub(crate) async fn tally(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(TallyQuery { order, lengths, assumed_units, sheet }): Query<TallyQuery>,
    file: File<MOST_BYTES>,
) -> Result<Json<Tally>> {
    import(&app, &caller, file, move |bytes| {
        let options = TallyOptions { sheet: sheet.as_deref(), order, lengths, assumed_units };
        drillsweep_import::tally(bytes, options)
    })
    .await
}

/// Read the hole of another program
///
/// Casings and open hole from CSV, Excel (`.xlsx`) or a WITSML 1.4.1.1 or 2.0 geometry of a wellbore, with headings and units. The answer has
/// `well.section`, the meaning of each column, and each cell that could not be used. Nothing is stored.
#[utoipa::path(
    post,
    path = "/v1/imports/hole",
    tag = "imports",
    operation_id = "import_hole",
    params(HoleQuery),
    request_body(content = Vec<u8>, content_type = "application/octet-stream", description = "Bytes of the file"),
    responses((status = 200, description = "The hole", body = HoleImport), Problems)
)]
pub(crate) async fn hole(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    Query(HoleQuery { assumed_units, sheet }): Query<HoleQuery>,
    file: File<MOST_BYTES>,
) -> Result<Json<HoleImport>> {
    import(&app, &caller, file, move |bytes| {
        drillsweep_import::hole(bytes, HoleOptions { sheet: sheet.as_deref(), assumed_units })
    })
    .await
}

/// Fit a mud
///
/// Yield power law of viscometer readings, with those of other conventions, or of plastic viscosity and yield point (API RP 13D). Nothing is
/// stored.
#[utoipa::path(
    post,
    path = "/v1/imports/mud",
    tag = "imports",
    operation_id = "import_mud",
    request_body = MudRequest,
    responses((status = 200, description = "The mud", body = MudAnswer), Problems)
)]
pub(crate) async fn mud(extract::Json(request): extract::Json<MudRequest>) -> Result<Json<MudAnswer>> {
    let pointer = |error: &MudError| match error {
        MudError::Range(number) => format!("/readings/{}", number - 1),
        MudError::Count(_) | MudError::NotViscous => "/readings".to_owned(),
        MudError::NoLaw => "/plastic_viscosity".to_owned(),
        MudError::Form => String::new(),
    };
    let answer = request.answer().map_err(|error| {
        let problem = FieldProblem {
            pointer: Some(pointer(&error)),
            parameter: None,
            got: None,
            detail: error.to_string(),
        };
        ProblemDetails::invalid_request(vec![problem])
    })?;
    Ok(Json(answer))
}

/// Reads a file in a place for expansions.
async fn import<T: Serialize + Send + 'static>(
    app: &App,
    caller: &Caller,
    file: File<MOST_BYTES>,
    read: impl FnOnce(&[u8]) -> std::result::Result<T, ImportError> + Send + 'static,
) -> Result<Json<T>> {
    let is_compressed = file.bytes.starts_with(b"PK");
    let memory = if is_compressed { MEMORY_OF_FILE } else { file.bytes.len() * MEMORY_OF_BYTE };
    let place = app.expansions.enter(caller.budget(), memory.min(MEMORY_OF_FILE)).await?;
    let work = move |_: &mut Work| Ok(read(&file.bytes).map_err(|error| problem(&error))?);
    Ok(Json(place.run(work).await?.0))
}

/// A file that is not read as a problem: of the parameter that decides what it leaves open, or else of its cells.
fn problem(error: &ImportError) -> ProblemDetails {
    let detail = error.to_string();
    if let Some(parameter) = error.option() {
        let got = match error {
            ImportError::Grid(GridError::NoSheet { wanted, .. }) => Some(wanted.as_str()),
            _ => None,
        };
        return ProblemDetails::invalid_parameter(parameter, got, detail);
    }
    let kind = match error {
        ImportError::Grid(GridError::Size) | ImportError::TooMany { .. } => ProblemKind::BodyTooLarge,
        _ => ProblemKind::MalformedBody,
    };
    let cell = |problem: &drillsweep_import::CellProblem| FieldProblem {
        pointer: None,
        parameter: None,
        got: (!problem.text.is_empty()).then(|| problem.text.clone().into()),
        detail: problem.to_string(),
    };
    let errors = error.problems().iter().map(cell).collect();
    ProblemDetails { errors, ..ProblemDetails::new(kind, detail) }
}
