//! Audit of changes and their callers: a line in the log for every request that changed something.

use crate::listen::Peer;
use axum::http::{Method, Uri, header};
use axum::response::Response;
use drillsweep_store::TokenRecord;

/// Owner of a change, if it is not that of the request's token.
#[derive(Debug, Clone)]
pub(crate) struct Owner(pub(crate) String);

/// Logs successful requests other than reads: address, token and owner. The request's id is in the span.
pub(crate) fn note(
    token: Option<&TokenRecord>,
    peer: Option<Peer>,
    method: &Method,
    uri: &Uri,
    response: &Response,
) {
    if is_reading(method, uri) || !response.status().is_success() {
        return;
    }
    // The path of the created sweep.
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

/// True for requests that change nothing: reads, parsing of a scenario's file or of a part of one, fits, and dry runs.
pub(crate) fn is_reading(method: &Method, uri: &Uri) -> bool {
    let is_dry_run = || uri.query().is_some_and(|query| query.split('&').any(|pair| pair == "dry_run=true"));
    match *method {
        Method::GET | Method::HEAD | Method::OPTIONS => true,
        Method::POST => match uri.path() {
            "/v1/scenarios" => true,
            path if path.starts_with("/v1/imports/") => true,
            "/v1/sweeps" | "/v1/runs" => is_dry_run(),
            path => path.starts_with("/v1/sweeps/") && path.ends_with("/friction"),
        },
        Method::DELETE => is_dry_run(),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dry_runs_are_those_of_routes_that_have_them() {
        let is = |method: Method, target: &str| is_reading(&method, &target.parse().expect("a target"));
        assert!(is(Method::GET, "/v1/sweeps") && is(Method::POST, "/v1/scenarios"));
        assert!(is(Method::POST, "/v1/imports/tally?order=from_bit"));
        assert!(
            is(Method::POST, "/v1/sweeps?cache=only&dry_run=true")
                && is(Method::POST, "/v1/runs?dry_run=true")
        );
        assert!(is(Method::DELETE, "/v1/sweeps/x?dry_run=true") && !is(Method::DELETE, "/v1/sweeps/x"));
        for target in ["/v1/sweeps", "/v1/sweeps?dry_run=false", "/v1/sweeps/x/cancel?dry_run=true"] {
            assert!(!is(Method::POST, target), "{target}");
        }
        assert!(!is(Method::PATCH, "/v1/sweeps/x?dry_run=true"));
    }
}
