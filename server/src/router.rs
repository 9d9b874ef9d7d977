//! All routes, in the order in which to read them.

use std::sync::LazyLock;

use axum::Router;
use axum::http::{Method, Uri, header};
use axum::response::IntoResponse;
use axum::routing::get;
use drillsweep_api::ProblemKind;
use drillsweep_store::Store;
use tokio::sync::watch;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::answer::error::Error;
use crate::app::{App, Config};
use crate::guard::middleware;
use crate::openapi;
use crate::openapi::answers::Problems;
use crate::route::{
    analysis, cost, events, export, files, forced, health, imports, mode_shapes, points, quantities, report,
    results, scenarios, session, snapshots, spectrogram, stability_map, statistics, status, sweeps,
    torque_drag, verification, web,
};

/// The OpenAPI 3.1 document of the service, from the annotations of routes and types.
pub static OPENAPI_JSON: LazyLock<String> = LazyLock::new(|| openapi::json(&for_programs().into_openapi()));

/// The service without the network. Long polls and event streams end when `stopping` is true.
pub fn router(store: Store, config: Config, stopping: watch::Receiver<bool>) -> Router {
    routes(&App::new(store, config, stopping))
}

pub(crate) fn routes(app: &App) -> Router {
    let routes = Router::from(for_programs())
        .merge(document_pages())
        .fallback(no_such_route)
        .method_not_allowed_fallback(method_not_allowed)
        .with_state(app.clone());
    middleware::wrap(routes, app)
}

/// Routes for programs, with the OpenAPI document of their annotations.
fn for_programs() -> OpenApiRouter<App> {
    OpenApiRouter::with_openapi(openapi::service())
        .routes(routes!(sweeps::submit::create, sweeps::list::list))
        .routes(routes!(sweeps::show::show, sweeps::change::change, sweeps::change::delete))
        .routes(routes!(sweeps::request::request))
        .routes(routes!(sweeps::change::cancel))
        .routes(routes!(sweeps::change::retry))
        .routes(routes!(sweeps::change::pause))
        .routes(routes!(sweeps::change::resume))
        .routes(routes!(sweeps::table::table))
        .routes(routes!(sweeps::window::window))
        .routes(routes!(sweeps::table::columns))
        .routes(routes!(report::of_sweep))
        .routes(routes!(verification::show))
        .routes(routes!(events::follow))
        .routes(routes!(export::export))
        .routes(routes!(sweeps::submit::create_run))
        .routes(routes!(points::list, sweeps::append::append))
        .routes(routes!(points::show))
        .routes(routes!(points::failures))
        .routes(routes!(files::list))
        .routes(routes!(files::show))
        .routes(routes!(results::profile))
        .routes(routes!(results::statics))
        .routes(routes!(results::history))
        .routes(routes!(snapshots::show))
        .routes(routes!(results::orbit))
        .routes(routes!(results::spectrum))
        .routes(routes!(spectrogram::show))
        .routes(routes!(results::lines))
        .routes(routes!(results::contacts))
        .routes(routes!(results::loads))
        .routes(routes!(results::energy))
        .routes(routes!(results::course))
        .routes(routes!(statistics::show))
        .routes(routes!(analysis::plan))
        .routes(routes!(analysis::modes))
        .routes(routes!(mode_shapes::show))
        .routes(routes!(stability_map::show))
        .routes(routes!(torque_drag::show))
        .routes(routes!(torque_drag::fit))
        .routes(routes!(forced::show))
        .routes(routes!(analysis::hydraulics))
        .routes(routes!(analysis::diagnosis))
        .routes(routes!(report::of_point))
        .routes(routes!(cost::show))
        .routes(routes!(scenarios::list, scenarios::read))
        .routes(routes!(scenarios::show))
        .routes(routes!(scenarios::pipes))
        .routes(routes!(imports::survey))
        .routes(routes!(imports::tally))
        .routes(routes!(imports::hole))
        .routes(routes!(imports::mud))
        .routes(routes!(quantities::list))
        .routes(routes!(status::workers))
        .routes(routes!(status::queue))
        .routes(routes!(status::limits))
        .routes(routes!(status::retention))
        .routes(routes!(session::show, session::open, session::close))
        .routes(routes!(show))
        .routes(routes!(health::alive))
        .routes(routes!(health::ready))
}

/// Pages and their files, which are not in the OpenAPI document.
fn document_pages() -> Router<App> {
    Router::new()
        .route("/", get(web::page))
        .route("/web/{version}/{*path}", get(web::file))
        .route("/docs", get(web::documentation))
}

/// The OpenAPI document of the service
#[utoipa::path(
    get,
    path = "/openapi.json",
    tag = "service",
    operation_id = "get_openapi",
    security(()),
    responses((status = 200, description = "The document", content_type = "application/json"), Problems)
)]
pub(crate) async fn show() -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "application/json")], OPENAPI_JSON.as_str())
}

async fn no_such_route(uri: Uri) -> Error {
    let detail = format!("there is no route {}; the routes are listed at /openapi.json", uri.path());
    Error::new(ProblemKind::NoSuchRoute, detail)
}

async fn method_not_allowed(method: Method, uri: Uri) -> Error {
    Error::new(ProblemKind::MethodNotAllowed, format!("{} does not allow {method}", uri.path()))
}
