//! Preset scenarios, and scenario files.

use axum::Extension;
use axum::extract::State;
use drillsweep_api::{
    LIMITS, ProblemKind, ScenarioDetail, ScenarioFile, ScenarioList, ScenarioRequest, preset_detail, presets,
};

use crate::answer::error::{Error, Result};
use crate::answer::extract::{self, Path, read_json};
use crate::answer::json::Json;
use crate::app::App;
use crate::app::expansions::Work;
use crate::guard::caller::Caller;
use crate::openapi::answers::Problems;

/// Memory at most that reading a byte of a scenario file takes, and a whole one \[bytes\].
const MEMORY_OF_BYTE: usize = 100;
const MEMORY_OF_FILE: usize = MEMORY_OF_BYTE * LIMITS.scenario_file_bytes;

/// The preset scenarios
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
/// For forms: the text of a file as commands take it, TOML or JSON, answered with what it asks for as a request says it, what the file
/// leaves out filled in. Nothing is stored, and whether it can be simulated is what a dry run of a sweep says.
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
