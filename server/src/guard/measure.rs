//! How long requests take.

use axum::extract::{MatchedPath, Request, State};
use axum::middleware::Next;
use axum::response::Response;

use crate::app::App;

/// Times every request; the route is that of the router, so that there are only as many as there are routes.
pub(crate) async fn measure(
    State(app): State<App>,
    matched: Option<MatchedPath>,
    request: Request,
    next: Next,
) -> Response {
    let start = std::time::Instant::now();
    let method = request.method().clone();
    let response = next.run(request).await;
    let route = matched.map_or_else(|| "none".to_owned(), |matched| matched.as_str().to_owned());
    app.metrics.count(&method, route, response.status(), start.elapsed());
    response
}
