//! Preset scenarios.

use axum::Json;
use drillsweep_api::{ProblemKind, ScenarioDetail, ScenarioList, preset_detail, presets};

use crate::answer::document::Problems;
use crate::answer::error::{Error, Result};
use crate::answer::extract::Path;

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
