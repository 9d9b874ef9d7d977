//! The OpenAPI document: description of the service as a whole, and the additions that annotations of routes and types cannot express.

pub(crate) mod answers;
mod vocabulary;

use drillsweep_api::{ExportManifest, LIMITS, PointEvent, PointList, ProblemDetails, SelectedPointList};
use drillsweep_table::Table;
use serde_json::{Value, json};
use utoipa::openapi::OpenApi;
use utoipa::openapi::security::{HttpAuthScheme, HttpBuilder, SecurityScheme};
use utoipa::{Modify, OpenApi as _};

/// The document without routes.
pub(crate) fn service() -> OpenApi {
    Document::openapi()
}

/// The document as indented JSON with a final newline.
pub(crate) fn json(document: &OpenApi) -> String {
    let mut document = json!(document);
    vocabulary::describe(&mut document);
    bound_members(&mut document);
    allow_units(&mut document);
    format!("{document:#}\n")
}

/// Allows texts with units as values of swept parameters.
fn allow_units(document: &mut Value) {
    let schemas = &mut document["components"]["schemas"];
    let ends = ["AxisRange", "AxisInterval"]
        .map(|axis| ["from", "to"].map(|end| format!("/{axis}/properties/{end}")));
    let points = ["SweepRequest", "AppendRequest"]
        .map(|request| format!("/{request}/properties/points/items/additionalProperties"));
    let values = "/AxisValues/properties/values/items".to_owned();
    for pointer in ends.into_iter().flatten().chain(points).chain([values]) {
        if let Some(schema) = schemas.pointer_mut(&pointer) {
            vocabulary::allow_text(schema);
        }
    }
}

/// Adds limits on numbers of members, which annotations cannot express.
fn bound_members(document: &mut Value) {
    for request in ["SweepRequest", "RunRequest", "AppendRequest"] {
        let members = &mut document["components"]["schemas"][request]["properties"];
        for (member, most) in [("set", LIMITS.changes_per_request), ("axes", LIMITS.axes_per_sweep)] {
            if let Some(schema) = members.get_mut(member) {
                schema["maxProperties"] = json!(most);
            }
        }
        if let Some(points) = members.get_mut("points") {
            points["items"]["maxProperties"] = json!(LIMITS.axes_per_sweep);
        }
    }
}

/// Description of the service as a whole, and the types that no route names.
#[derive(utoipa::OpenApi)]
#[openapi(
    info(
        title = "drillsweep",
        version = "1",
        description = "Sweeps of a nonlinear drillstring simulation over flow rate, mud density and any other number. \
            SI units throughout; a field in another unit says so in its name. In requests a number of a scenario, of a change \
            or of an axis may be a text with its unit, such as `\"10.5 ppg\"`, `\"500 gpm\"` or `\"12 1/4 in\"`; answers have numbers. \
            Tables and pictures are in SI units or in those that `units` chooses.",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    components(schemas(
        ProblemDetails, Table, ExportManifest, PointEvent, PointList, SelectedPointList
    )),
    modifiers(&TokenSecurity),
    security(("token" = []), ()),
    tags(
        (name = "sweeps", description = "Submit sweeps and single runs, and follow them"),
        (name = "points", description = "The points of a sweep and their results"),
        (name = "scenarios", description = "Preset scenarios"),
        (name = "imports", description = "Parts of a scenario from files of other programs"),
        (name = "service", description = "The service itself"),
    )
)]
struct Document;

/// Adds the scheme of tokens; the alternative without one holds until the first token exists.
struct TokenSecurity;

impl Modify for TokenSecurity {
    fn modify(&self, document: &mut OpenApi) {
        let scheme = HttpBuilder::new()
            .scheme(HttpAuthScheme::Bearer)
            .description(Some(
                "A token of `drillsweep token create`. Its scope is read, submit or admin. Until the first token \
                 exists none is needed, and the service listens on its own machine only.",
            ))
            .build();
        let components = document.components.get_or_insert_default();
        components.add_security_scheme("token", SecurityScheme::Http(scheme));
    }
}
