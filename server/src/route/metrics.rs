//! Counts of the service for operators, on a listener of its own.

use axum::Router;

use crate::app::App;
use crate::exposition;
use crate::route::status::WORKER_SILENCE;

/// `/metrics`, for the listener of its own.
pub(crate) fn router(app: App) -> Router {
    exposition::router(move || {
        let app = app.clone();
        async move {
            let census = app.store.census(WORKER_SILENCE).await?;
            app.metrics.text(&census, app.streams.number(), &app.lanes())
        }
    })
}
