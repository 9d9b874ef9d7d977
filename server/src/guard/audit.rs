//! Who changed what: a line in the log for every request that changed something.

use axum::http::{Method, Uri, header};
use axum::response::Response;

use crate::guard::auth::Caller;

/// Notes a request that was carried out; those that only read are not noted. The request's id is in the line's span.
pub(crate) fn note(caller: &Caller, method: &Method, uri: &Uri, response: &Response) {
    if is_reading(method) || !response.status().is_success() {
        return;
    }
    // Of what was made.
    let location = response.headers().get(header::LOCATION).and_then(|value| value.to_str().ok());
    let token = match caller {
        Caller::Local => None,
        Caller::Bearer(token) => Some(token),
    };
    tracing::info!(
        owner = token.map(|token| token.owner.as_str()),
        token.id = token.map(|token| token.id.as_str()),
        http.method = %method,
        http.target = %uri,
        http.status = response.status().as_u16(),
        made = location,
        "changed"
    );
}

/// Whether requests of this method change nothing.
pub(crate) fn is_reading(method: &Method) -> bool {
    matches!(*method, Method::GET | Method::HEAD | Method::OPTIONS)
}
