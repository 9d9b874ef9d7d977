//! Request of a sweep, whatever its length.

use std::io::Write as _;

use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse as _, Response};
use drillsweep_api::SweepRequest;
use tokio::runtime::Handle;
use tokio::sync::mpsc;

use crate::answer::blocking::beside;
use crate::answer::body::{Sink, WAITING_CHUNKS};
use crate::answer::error::{Error, Result};
use crate::answer::extract::Path;
use crate::answer::{chunk, records};
use crate::app::App;
use crate::openapi::answers::Problems;

/// Request of a sweep
///
/// As it was submitted; `GET /v1/sweeps/{id}` has it too if it is no longer than 64 KiB.
#[utoipa::path(
    get,
    path = "/v1/sweeps/{id}/request",
    tag = "sweeps",
    operation_id = "get_request",
    params(("id" = String, Path, description = "Identifier of the sweep")),
    responses((status = 200, description = "The request", body = SweepRequest), Problems)
)]
pub(crate) async fn request(State(app): State<App>, Path(id): Path<String>) -> Result<Response> {
    let missing = || records::no_such_sweep(&id);
    let bytes = app.store.request_bytes(&id).await?.ok_or_else(missing)?;
    // The database has a second copy while it is read.
    let place = app.view(2 * bytes.unsigned_abs()).await?;
    let text = app.store.request_json(&id).await?.ok_or_else(missing)?;
    let (held, allowance) = place.into_parts();
    let (sender, receiver) = mpsc::channel(WAITING_CHUNKS);
    let runtime = Handle::current();
    beside(move || {
        let _held = held;
        let mut sink = Sink::new(sender, runtime, None, allowance);
        match sink.write_all(text.as_bytes()) {
            Ok(()) => sink.finish(),
            Err(_) if sink.is_abandoned() => {}
            Err(error) => sink.fail(Error::internal(&error)),
        }
    })?;
    Ok(([(header::CONTENT_TYPE, "application/json")], chunk::body(None, receiver)).into_response())
}
