//! Durations of requests.

use std::time::Duration;

use axum::extract::{MatchedPath, Request, State};
use axum::http::Uri;
use axum::middleware::Next;
use axum::response::Response;

use crate::app::App;

/// Time to the headers of an answer from which its request is logged as slow.
const SLOW: Duration = Duration::from_secs(2);

/// Measures every request, by the pattern of its route, so that series are bounded.
pub(crate) async fn measure(
    State(app): State<App>,
    matched: Option<MatchedPath>,
    request: Request,
    next: Next,
) -> Response {
    let start = std::time::Instant::now();
    let (method, uri) = (request.method().clone(), request.uri().clone());
    let response = next.run(request).await;
    let took = start.elapsed();
    if is_slow(took, &uri) {
        tracing::info!(http.method = %method, http.target = %uri, seconds = took.as_secs_f64(), "slow request");
    }
    let route = matched.map_or_else(|| "none".to_owned(), |matched| matched.as_str().to_owned());
    app.metrics.count(&method, route, response.status(), took);
    response
}

/// True if a request is logged as slow. Long polls wait by design.
fn is_slow(took: Duration, uri: &Uri) -> bool {
    took > SLOW && !uri.query().is_some_and(|query| query.contains("wait="))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_of_more_than_two_seconds_are_slow_but_for_long_polls() {
        let is = |milliseconds, target: &str| {
            is_slow(Duration::from_millis(milliseconds), &target.parse().expect("a target"))
        };
        assert!(is(2_001, "/v1/sweeps") && is(2_001, "/v1/sweeps?limit=10"));
        assert!(!is(2_000, "/v1/sweeps") && !is(1, "/v1/sweeps"));
        assert!(!is(2_001, "/v1/sweeps/x?wait=30s") && !is(1, "/v1/sweeps/x?wait=30s"));
    }
}
