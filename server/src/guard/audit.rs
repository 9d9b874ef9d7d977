//! Who changed what: a line in the log for every request that changed something.

use crate::listen::Peer;
use axum::http::{Method, Uri, header};
use axum::response::Response;
use drillsweep_store::TokenRecord;

/// In whose name something was done, where the request's token does not say it.
#[derive(Debug, Clone)]
pub(crate) struct Owner(pub(crate) String);

/// Notes a request that was carried out: from where it came, with which token where there are any, and in whose name. Those that only read
/// are not noted. The request's id is in the line's span.
pub(crate) fn note(
    token: Option<&TokenRecord>,
    peer: Option<Peer>,
    method: &Method,
    uri: &Uri,
    response: &Response,
) {
    let is_dry_run = uri.query().is_some_and(|query| query.split('&').any(|pair| pair == "dry_run=true"));
    if is_reading(method) || is_dry_run || uri.path() == READS || !response.status().is_success() {
        return;
    }
    // Of what was made.
    let location = response.headers().get(header::LOCATION).and_then(|value| value.to_str().ok());
    let owner = response.extensions().get::<Owner>().map(|owner| owner.0.as_str());
    tracing::info!(
        owner = token.map(|token| token.owner.as_str()).or(owner),
        peer = peer.map(|peer| peer.0.to_string()),
        token.id = token.map(|token| token.id.as_str()),
        http.method = %method,
        http.target = %uri,
        http.status = response.status().as_u16(),
        made = location,
        "changed"
    );
}

/// Reads a scenario file, which comes as a body.
const READS: &str = "/v1/scenarios";

/// Whether requests of this method change nothing.
pub(crate) fn is_reading(method: &Method) -> bool {
    matches!(*method, Method::GET | Method::HEAD | Method::OPTIONS)
}
