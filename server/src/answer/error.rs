//! Errors of handlers: problem documents in place of answers.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use drillsweep_api::{ProblemDetails, ProblemKind};
use drillsweep_chart::ChartError;
use drillsweep_store::StoreError;
use drillsweep_table::TableError;

/// The result of a handler.
pub(crate) type Result<T, E = Error> = std::result::Result<T, E>;

/// A problem to be sent to the client. Details for the operator alone are logged where it is made.
#[derive(Debug, Clone)]
pub(crate) struct Error {
    problem: Box<ProblemDetails>,
    /// Retry-After \[s\].
    retry_after: Option<u32>,
}

impl Error {
    /// A problem of one kind.
    pub(crate) fn new(kind: ProblemKind, detail: impl Into<String>) -> Self {
        ProblemDetails::new(kind, detail).into()
    }

    /// A path, query or header parameter that is not valid.
    pub(crate) fn parameter(name: &str, got: Option<&str>, detail: impl Into<String>) -> Self {
        ProblemDetails::invalid_parameter(name, got, detail).into()
    }

    /// A failure of the service itself, whose reason is logged and not sent.
    pub(crate) fn internal(reason: &(impl std::fmt::Display + ?Sized)) -> Self {
        tracing::error!(%reason, "a request failed");
        Error::new(ProblemKind::Internal, "the service failed; its log has the reason under this request id")
    }

    /// A failure that is expected to pass within a second.
    pub(crate) fn unavailable(reason: &(impl std::fmt::Display + ?Sized)) -> Self {
        Self::unavailable_for(reason, Duration::from_secs(1))
    }

    /// A failure that is expected to pass after `wait`, which is rounded up to seconds.
    pub(crate) fn unavailable_for(reason: &(impl std::fmt::Display + ?Sized), wait: Duration) -> Self {
        if let Some(unlogged) = REFUSALS.next() {
            tracing::warn!(%reason, unlogged, "a request could not be served for the time being");
        }
        let seconds = whole_seconds(wait);
        let detail = format!("the service is busy; try again in {seconds} s");
        Error { retry_after: Some(seconds), ..Error::new(ProblemKind::Unavailable, detail) }
    }

    /// The request needs a token.
    pub(crate) fn unauthorized(detail: &str) -> Self {
        Error::new(ProblemKind::Unauthorized, detail)
    }

    /// A temporary problem: a retry may succeed after `wait`.
    pub(crate) fn temporary(kind: ProblemKind, detail: impl Into<String>, wait: Duration) -> Self {
        Error { retry_after: Some(whole_seconds(wait)), ..Error::new(kind, detail) }
    }

    /// True for a problem of this kind.
    pub(crate) fn is_of(&self, kind: ProblemKind) -> bool {
        self.problem.type_uri == kind.uri()
    }

    /// The problem without the id of the request.
    pub(crate) fn into_problem(self) -> ProblemDetails {
        *self.problem
    }
}

/// Log of refusals, limited so that a storm of them does not fill the disk.
static REFUSALS: Sparse = Sparse::new(Duration::from_secs(1));

/// Log lines of one kind, at most one in a time span.
struct Sparse {
    between: Duration,
    state: Mutex<(Option<Instant>, u64)>,
}

impl Sparse {
    const fn new(between: Duration) -> Self {
        Self { between, state: Mutex::new((None, 0)) }
    }

    /// Number of lines left out since the last one, if a line is due.
    fn next(&self) -> Option<u64> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let (last, unlogged) = &mut *state;
        if last.is_some_and(|last| last.elapsed() < self.between) {
            *unlogged += 1;
            return None;
        }
        *last = Some(Instant::now());
        Some(std::mem::take(unlogged))
    }
}

fn whole_seconds(wait: Duration) -> u32 {
    u32::try_from(wait.as_secs_f64().ceil() as u64).unwrap_or(u32::MAX).max(1)
}

impl From<Box<ProblemDetails>> for Error {
    fn from(problem: Box<ProblemDetails>) -> Self {
        Error { problem, retry_after: None }
    }
}

impl From<ProblemDetails> for Error {
    fn from(problem: ProblemDetails) -> Self {
        Box::new(problem).into()
    }
}

impl From<StoreError> for Error {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::IdempotencyConflict => {
                Error::new(ProblemKind::IdempotencyKeyReused, error.to_string())
            }
            error if error.is_full() => {
                tracing::error!(%error, "the disk is full");
                Error::new(ProblemKind::StorageFull, "the service's disk is full; nothing was stored")
            }
            error if error.is_busy() || error.is_unavailable() => Error::unavailable(&error),
            error => Error::internal(&error),
        }
    }
}

/// A picture that cannot be drawn, by the query parameter that chose it.
impl From<ChartError> for Error {
    fn from(error: ChartError) -> Self {
        let detail = error.to_string();
        let (parameter, got) = match error {
            ChartError::NoField { .. } => ("fields", None),
            ChartError::NoSuchColumn { name, .. }
            | ChartError::OtherUnit { name }
            | ChartError::Texts { name } => ("fields", Some(name)),
            ChartError::NoSuchParameter { name, .. } => ("slice", Some(name)),
            ChartError::NoSuchValue { value, .. } => ("slice", Some(value.to_string())),
        };
        Error::parameter(parameter, got.as_deref(), detail)
    }
}

impl From<TableError> for Error {
    fn from(error: TableError) -> Self {
        Error::internal(&error)
    }
}

impl IntoResponse for Error {
    /// A response without a body, which the middleware writes with the request's id.
    fn into_response(self) -> Response {
        let status = StatusCode::from_u16(self.problem.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let mut response = status.into_response();
        if let Some(seconds) = self.retry_after {
            response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        if status == StatusCode::UNAUTHORIZED {
            response.headers_mut().insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        response.extensions_mut().insert(self);
        response
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    #[test]
    fn a_picture_that_cannot_be_drawn_names_parameter_and_value() {
        let problem = |parameter: &str, got: Option<&str>, detail: &str| {
            let mut error = json!({"parameter": parameter, "detail": detail});
            if let Some(got) = got {
                error["got"] = got.into();
            }
            json!({
                "type": "urn:drillsweep:problem:invalid-parameter",
                "title": "A parameter is not valid",
                "status": 400,
                "detail": format!("{parameter}: {detail}"),
                "errors": [error],
            })
        };
        let served = |error: ChartError| -> Value {
            serde_json::to_value(Error::from(error).into_problem()).expect("a problem is JSON")
        };
        let names = || vec!["u_49".to_owned(), "time".to_owned()];
        let name = || "x".to_owned();
        for (error, expected) in [
            (
                ChartError::NoField { columns: names() },
                problem("fields", None, "a picture needs a column; there are u_49, time"),
            ),
            (
                ChartError::NoSuchColumn { name: name(), columns: names() },
                problem("fields", Some("x"), "there is no such column; there are u_49, time"),
            ),
            (
                ChartError::OtherUnit { name: name() },
                problem(
                    "fields",
                    Some("x"),
                    "the columns of a picture must have one unit; x has another than the first",
                ),
            ),
            (
                ChartError::Texts { name: name() },
                problem("fields", Some("x"), "is a column of texts, which a picture cannot show"),
            ),
            (
                ChartError::NoSuchParameter { name: name(), parameters: names() },
                problem("slice", Some("x"), "the sweep has no such parameter; it has u_49, time"),
            ),
            (
                ChartError::NoSuchValue { parameter: name(), value: 0.5, nearest: vec![0.25, 1.0] },
                problem("slice", Some("0.5"), "no point has this value of x; the nearest are 0.25, 1"),
            ),
        ] {
            assert_eq!(served(error), expected);
        }
    }

    #[test]
    fn lines_of_one_kind_are_sparse_and_count_those_left_out() {
        let sparse = Sparse::new(Duration::from_secs(3_600));
        let lines = (0..100).filter_map(|_| sparse.next()).collect::<Vec<_>>();
        assert_eq!(lines, [0]);
        let each = Sparse::new(Duration::ZERO);
        assert_eq!((each.next(), each.next()), (Some(0), Some(0)));
        *sparse.state.lock().expect("nobody panics") = (None, 99);
        assert_eq!(sparse.next(), Some(99));
    }
}
