//! All routes, in the order in which to read them.

use std::io::Read as _;
use std::sync::LazyLock;

use axum::Router;
use axum::http::{Method, Uri, header};
use axum::response::IntoResponse;
use axum::routing::{MethodRouter, get, post};
use drillsweep_api::ProblemKind;
use drillsweep_store::Store;
use flate2::read::GzDecoder;
use tokio::sync::watch;

use crate::answer::error::Error;
use crate::app::{App, Config};
use crate::guard::middleware;
use crate::openapi::answers::Problems;
use crate::route::{
    analysis, cost, events, export, files, health, points, quantities, results, scenarios, session,
    snapshots, spectrogram, statistics, status, sweeps, verification, web,
};

/// The OpenAPI 3.1 document of the service, embedded compressed, at a tenth of its size.
pub static OPENAPI_JSON: LazyLock<String> = LazyLock::new(|| {
    let compressed: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/openapi.json.gz"));
    let mut document = String::new();
    GzDecoder::new(compressed).read_to_string(&mut document).expect("the build compresses text");
    document
});

/// The service without the network. Long polls and event streams end when `stopping` is true.
pub fn router(store: Store, config: Config, stopping: watch::Receiver<bool>) -> Router {
    routes(&App::new(store, config, stopping))
}

pub(crate) fn routes(app: &App) -> Router {
    let routes = for_programs()
        .into_iter()
        .fold(for_people(), |routes, (path, methods)| routes.route(path, methods))
        .fallback(no_such_route)
        .method_not_allowed_fallback(method_not_allowed)
        .with_state(app.clone());
    middleware::wrap(routes, app)
}

/// Routes for programs with their handlers: those of the OpenAPI document, which is made from annotations of the same functions.
fn for_programs() -> Vec<(&'static str, MethodRouter<App>)> {
    vec![
        ("/v1/sweeps", post(sweeps::submit::create).get(sweeps::list::list)),
        (
            "/v1/sweeps/{id}",
            get(sweeps::show::show).patch(sweeps::change::change).delete(sweeps::change::delete),
        ),
        ("/v1/sweeps/{id}/cancel", post(sweeps::change::cancel)),
        ("/v1/sweeps/{id}/retry", post(sweeps::change::retry)),
        ("/v1/sweeps/{id}/pause", post(sweeps::change::pause)),
        ("/v1/sweeps/{id}/resume", post(sweeps::change::resume)),
        ("/v1/sweeps/{id}/table", get(sweeps::table::table)),
        ("/v1/sweeps/{id}/table/columns", get(sweeps::table::columns)),
        ("/v1/sweeps/{id}/verification", get(verification::show)),
        ("/v1/sweeps/{id}/events", get(events::follow)),
        ("/v1/sweeps/{id}/export", get(export::export)),
        ("/v1/runs", post(sweeps::submit::create_run)),
        ("/v1/sweeps/{id}/points", get(points::list).post(sweeps::append::append)),
        ("/v1/sweeps/{id}/points/{n}", get(points::show)),
        ("/v1/failures", get(points::failures)),
        ("/v1/sweeps/{id}/points/{n}/artifacts", get(files::list)),
        ("/v1/sweeps/{id}/points/{n}/artifacts/{name}", get(files::show)),
        ("/v1/sweeps/{id}/points/{n}/profile", get(results::profile)),
        ("/v1/sweeps/{id}/points/{n}/statics", get(results::statics)),
        ("/v1/sweeps/{id}/points/{n}/history", get(results::history)),
        ("/v1/sweeps/{id}/points/{n}/snapshots", get(snapshots::show)),
        ("/v1/sweeps/{id}/points/{n}/orbit", get(results::orbit)),
        ("/v1/sweeps/{id}/points/{n}/spectrum", get(results::spectrum)),
        ("/v1/sweeps/{id}/points/{n}/spectrogram", get(spectrogram::show)),
        ("/v1/sweeps/{id}/points/{n}/contacts", get(results::contacts)),
        ("/v1/sweeps/{id}/points/{n}/energy", get(results::energy)),
        ("/v1/sweeps/{id}/points/{n}/course", get(results::course)),
        ("/v1/sweeps/{id}/points/{n}/statistics", get(statistics::show)),
        ("/v1/sweeps/{id}/points/{n}/plan", get(analysis::plan)),
        ("/v1/sweeps/{id}/points/{n}/modes", get(analysis::modes)),
        ("/v1/sweeps/{id}/points/{n}/cost", get(cost::show)),
        ("/v1/scenarios", get(scenarios::list).post(scenarios::read)),
        ("/v1/scenarios/{name}", get(scenarios::show)),
        ("/v1/quantities", get(quantities::list)),
        ("/v1/workers", get(status::workers)),
        ("/v1/queue", get(status::queue)),
        ("/v1/limits", get(status::limits)),
        ("/v1/retention", get(status::retention)),
        ("/v1/session", get(session::show).post(session::open).delete(session::close)),
        ("/openapi.json", get(show)),
        ("/livez", get(health::alive)),
        ("/readyz", get(health::ready)),
    ]
}

/// Pages and their files, which are not in the OpenAPI document.
fn for_people() -> Router<App> {
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
    let detail = format!("there is nothing at {}; the routes are listed at /openapi.json", uri.path());
    Error::new(ProblemKind::NoSuchRoute, detail)
}

async fn method_not_allowed(method: Method, uri: Uri) -> Error {
    Error::new(ProblemKind::MethodNotAllowed, format!("{} does not allow {method}", uri.path()))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use axum::body::Body;
    use axum::http::{Request, StatusCode};
    use drillsweep_store::{Role, StoreConfig};
    use serde_json::Value;
    use tower::ServiceExt;

    use super::*;

    /// Methods and paths of the document.
    fn documented() -> BTreeSet<String> {
        let document: Value = serde_json::from_str(&OPENAPI_JSON).expect("JSON");
        let paths = document["paths"].as_object().expect("paths").iter();
        paths
            .flat_map(|(path, operations)| {
                let methods = operations.as_object().expect("operations").keys();
                methods.map(move |method| format!("{} {path}", method.to_uppercase()))
            })
            .collect()
    }

    #[tokio::test]
    async fn the_routes_for_programs_are_those_of_the_document() {
        let directory = tempfile::tempdir().expect("a directory");
        let config = StoreConfig::in_directory(directory.path(), Role::Server);
        let store = Store::open(&config).await.expect("a store");
        let (_stop, stopping) = watch::channel(false);
        let service = router(store, Config::default(), stopping);
        let mut routed = BTreeSet::new();
        for (path, _) in for_programs() {
            // No route has this method, so that the answer lists the methods that exist.
            let uri = path.replace(['{', '}'], "");
            let request = Request::builder().method(Method::TRACE).uri(uri).body(Body::empty());
            let answer = service.clone().oneshot(request.expect("a request")).await.expect("an answer");
            assert_eq!(answer.status(), StatusCode::METHOD_NOT_ALLOWED, "{path}");
            let allowed = answer.headers()[header::ALLOW].to_str().expect("text");
            // Routes with GET have HEAD, which the document does not list.
            let methods = allowed.split(',').filter(|method| *method != "HEAD");
            routed.extend(methods.map(|method| format!("{method} {path}")));
        }
        assert_eq!(routed, documented());
    }
}
