//! Metrics of the service, on a separate listener.

use axum::Router;

use crate::app::App;
use crate::exposition;
use crate::route::status::WORKER_SILENCE;

/// Route `/metrics` of the separate listener.
pub(crate) fn router(app: App) -> Router {
    exposition::router(move || {
        let app = app.clone();
        async move {
            let census = app.store.census(WORKER_SILENCE).await?;
            app.metrics.text(&census, app.streams.number(), &app.lanes())
        }
    })
}
