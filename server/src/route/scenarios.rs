//! Preset scenarios, scenario files, and the catalogue of pipes.

use axum::Extension;
use axum::extract::State;
use drillsweep_api::{
    LIMITS, PipeList, ProblemKind, ScenarioDetail, ScenarioFile, ScenarioList, ScenarioRequest,
    preset_detail, presets,
};

use crate::answer::error::{Error, Result};
use crate::answer::extract::{self, Path, read_json};
use crate::answer::json::Json;
use crate::app::App;
use crate::app::expansions::Work;
use crate::guard::caller::Caller;
use crate::openapi::answers::Problems;

/// Bounds on the memory for parsing a byte of a scenario file, and a whole file \[bytes\].
const MEMORY_OF_BYTE: usize = 100;
const MEMORY_OF_FILE: usize = MEMORY_OF_BYTE * LIMITS.scenario_file_bytes;

/// Preset scenarios
#[utoipa::path(
    get,
    path = "/v1/scenarios",
    tag = "scenarios",
    operation_id = "list_scenarios",
    responses((status = 200, description = "Every preset", body = ScenarioList), Problems)
)]
pub(crate) async fn list() -> Json<ScenarioList> {
    Json(presets())
}

/// Read a scenario file
///
/// For forms: converts a scenario file of the commands, TOML or JSON, to the scenario of a request, with defaults filled in. Nothing is
/// stored; a dry run of a sweep validates the scenario.
#[utoipa::path(
    post,
    path = "/v1/scenarios",
    tag = "scenarios",
    operation_id = "read_scenario",
    request_body = ScenarioFile,
    responses((status = 200, description = "The request of the file", body = ScenarioRequest), Problems)
)]
pub(crate) async fn read(
    State(app): State<App>,
    Extension(caller): Extension<Caller>,
    body: extract::Body,
) -> Result<Json<ScenarioRequest>> {
    let memory = body.bytes.len().saturating_mul(MEMORY_OF_BYTE).min(MEMORY_OF_FILE);
    let place = app.expansions.enter(caller.budget(), memory).await?;
    let read = move |_: &mut Work| {
        let file: ScenarioFile = read_json(&body.bytes)?;
        Ok(file.read().map_err(|problem| *problem)?)
    };
    Ok(Json(place.run(read).await?.0))
}

/// One preset scenario in full
#[utoipa::path(
    get,
    path = "/v1/scenarios/{name}",
    tag = "scenarios",
    operation_id = "get_scenario",
    params(("name" = String, Path, description = "Name of the preset", example = "paper-200m")),
    responses((status = 200, description = "The preset", body = ScenarioDetail), Problems)
)]
pub(crate) async fn show(Path(name): Path<String>) -> Result<Json<ScenarioDetail>> {
    match preset_detail(&name) {
        Some(detail) => Ok(Json(detail)),
        None => {
            let detail = format!("there is no preset {name}; the presets are listed at /v1/scenarios");
            Err(Error::new(ProblemKind::NotFound, detail))
        }
    }
}

/// Catalogue of pipes
///
/// Drillpipe, heavy-weight drillpipe and collars by the names that `pipe` of a section has, with the fields that it fills in.
#[utoipa::path(
    get,
    path = "/v1/pipes",
    tag = "scenarios",
    operation_id = "list_pipes",
    responses((status = 200, description = "Every pipe", body = PipeList), Problems)
)]
pub(crate) async fn pipes() -> Json<PipeList> {
    Json(drillsweep_api::pipes())
}
