//! All routes, in the order in which a newcomer should read them, and the OpenAPI document that they make up.

use std::sync::LazyLock;

use axum::Router;
use axum::http::{Method, Uri, header};
use axum::response::IntoResponse;
use axum::routing::get;
use drillsweep_api::ProblemKind;
use drillsweep_store::Store;
use serde_json::json;
use tokio::sync::watch;
use utoipa::OpenApi;
use utoipa_axum::{router::OpenApiRouter, routes};

use crate::answer::document::{Document, Problems};
use crate::answer::error::Error;
use crate::answer::vocabulary;
use crate::app::{App, Config};
use crate::guard::middleware;
use crate::route::{
    all_events, cost, events, export, files, health, points, quantities, results, scenarios, scene, session,
    snapshots, spectrogram, statistics, status, sweeps, verification, web,
};

/// The service without the network. `stopping` ends long polls when it turns true.
pub fn router(store: Store, config: Config, stopping: watch::Receiver<bool>) -> Router {
    routes(&App::new(store, config, stopping))
}

pub(crate) fn routes(app: &App) -> Router {
    let (routes, _) = documented().split_for_parts();
    let routes = routes
        .fallback(no_such_route)
        .method_not_allowed_fallback(method_not_allowed)
        .with_state(app.clone());
    middleware::wrap(routes, app)
}

/// Routes and their OpenAPI document; none for programs can exist without its entry there.
fn documented() -> OpenApiRouter<App> {
    OpenApiRouter::with_openapi(Document::openapi())
        .routes(routes!(sweeps::create, sweeps::list))
        .routes(routes!(sweeps::show, sweeps::change, sweeps::delete))
        .routes(routes!(sweeps::cancel))
        .routes(routes!(sweeps::retry))
        .routes(routes!(sweeps::pause))
        .routes(routes!(sweeps::resume))
        .routes(routes!(sweeps::table))
        .routes(routes!(sweeps::columns))
        .routes(routes!(verification::show))
        .routes(routes!(events::follow))
        .routes(routes!(all_events::follow))
        .routes(routes!(export::export))
        .routes(routes!(sweeps::create_run))
        .routes(routes!(points::list, sweeps::append))
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
        .routes(routes!(results::contacts))
        .routes(routes!(results::energy))
        .routes(routes!(statistics::show))
        .routes(routes!(scene::plan))
        .routes(routes!(scene::modes))
        .routes(routes!(cost::show))
        .routes(routes!(scenarios::list, scenarios::read))
        .routes(routes!(scenarios::show))
        .routes(routes!(quantities::list))
        .routes(routes!(status::workers))
        .routes(routes!(status::queue))
        .routes(routes!(status::limits))
        .routes(routes!(status::retention))
        .routes(routes!(session::show, session::open, session::close))
        .routes(routes!(show))
        // For people: no part of what programs talk to.
        .route("/", get(web::page))
        .route("/web/{version}/{*path}", get(web::file))
        .route("/docs", get(web::documentation))
        .routes(routes!(health::alive))
        .routes(routes!(health::ready))
}

/// The OpenAPI 3.1 document of the service as it is served and committed: indented JSON with a final newline.
pub fn openapi_json() -> &'static str {
    static TEXT: LazyLock<String> = LazyLock::new(|| {
        let mut document = json!(documented().into_openapi());
        vocabulary::describe(&mut document);
        format!("{document:#}\n")
    });
    &TEXT
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
async fn show() -> impl IntoResponse {
    ([(header::CONTENT_TYPE, "application/json")], openapi_json())
}

async fn no_such_route(uri: Uri) -> Error {
    let detail = format!("there is nothing at {}; the routes are listed at /openapi.json", uri.path());
    Error::new(ProblemKind::NoSuchRoute, detail)
}

async fn method_not_allowed(method: Method, uri: Uri) -> Error {
    Error::new(ProblemKind::MethodNotAllowed, format!("{} does not allow {method}", uri.path()))
}
