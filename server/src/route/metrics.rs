//! What is counted for operators, on a listener of its own.

use axum::Router;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use axum::routing::get;

use crate::app::App;
use crate::app::metrics::TEXT;
use crate::route::status::WORKER_SILENCE;

/// `/metrics`, for the listener of its own.
pub(crate) fn router(app: App) -> Router {
    Router::new().route("/metrics", get(show)).with_state(app)
}

async fn show(State(app): State<App>) -> Response {
    let answer = async {
        let census = app.store.census(WORKER_SILENCE).await?;
        app.metrics.text(&census, app.streams.number(), &app.lanes())
    };
    match answer.await {
        Ok(text) => ([(header::CONTENT_TYPE, TEXT)], text).into_response(),
        Err(error) => error.into_response(),
    }
}
