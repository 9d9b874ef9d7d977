//! The OpenAPI document from the annotations of routes and types. The served document is the committed one, which a test compares.

pub(crate) mod answers;
mod vocabulary;

use drillsweep_api::{ExportManifest, LIMITS, PointEvent, PointList, ProblemDetails, SelectedPointList};
use drillsweep_table::Table;
use serde_json::{Value, json};
use utoipa::openapi::security::{HttpAuthScheme, HttpBuilder, SecurityScheme};
use utoipa::{Modify, OpenApi};

use crate::route::{
    analysis, cost, events, export, files, health, points, quantities, results, scenarios, session,
    snapshots, spectrogram, statistics, status, sweeps, verification,
};

/// Text of the committed document: indented JSON with a final newline.
pub fn openapi_of_annotations() -> String {
    let mut document = json!(Document::openapi());
    vocabulary::describe(&mut document);
    bound_members(&mut document);
    format!("{document:#}\n")
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

/// The document: the service as a whole, and its annotated routes and types.
#[derive(OpenApi)]
#[openapi(
    info(
        title = "drillsweep",
        version = "1",
        description = "Sweeps of a nonlinear drillstring simulation over flow rate, mud density and any other number. \
            SI units throughout; a field in another unit says so in its name.",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    paths(
        sweeps::submit::create,
        sweeps::list::list,
        sweeps::show::show,
        sweeps::change::change,
        sweeps::change::delete,
        sweeps::change::cancel,
        sweeps::change::retry,
        sweeps::change::pause,
        sweeps::change::resume,
        sweeps::table::table,
        sweeps::table::columns,
        verification::show,
        events::follow,
        export::export,
        sweeps::submit::create_run,
        points::list,
        sweeps::append::append,
        points::show,
        points::failures,
        files::list,
        files::show,
        results::profile,
        results::statics,
        results::history,
        snapshots::show,
        results::orbit,
        results::spectrum,
        spectrogram::show,
        results::contacts,
        results::energy,
        results::course,
        statistics::show,
        analysis::plan,
        analysis::modes,
        cost::show,
        scenarios::list,
        scenarios::read,
        scenarios::show,
        quantities::list,
        status::workers,
        status::queue,
        status::limits,
        status::retention,
        session::show,
        session::open,
        session::close,
        crate::router::show,
        health::alive,
        health::ready,
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
        (name = "service", description = "The service itself"),
    )
)]
struct Document;

/// Adds the scheme of tokens; the alternative without one holds until the first token exists.
struct TokenSecurity;

impl Modify for TokenSecurity {
    fn modify(&self, document: &mut utoipa::openapi::OpenApi) {
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
