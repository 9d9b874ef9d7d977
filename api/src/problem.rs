//! Errors on the wire: RFC 9457 problem details, all of a request's problems at once.

use drillsweep_quantity::entry;
use drillsweep_scenario::Problem;
use drillsweep_table::Table;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::point::PointState;

/// The media type of [`ProblemDetails`].
pub const PROBLEM_MEDIA_TYPE: &str = "application/problem+json";

/// The kinds of problem. Each has a stable type URI, a title and an HTTP status.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ProblemKind {
    /// The body is not JSON, or not of the documented form.
    MalformedBody,
    /// The body is well-formed but its scenario cannot be simulated.
    InvalidRequest,
    /// The request takes too long to prepare.
    TooMuchWork,
    /// A path, query or header parameter is missing, unknown or out of range.
    InvalidParameter,
    /// The body's media type is not accepted.
    UnsupportedMediaType,
    /// No token, or one that is not valid.
    Unauthorized,
    /// The token does not allow it.
    Forbidden,
    /// The owner makes too many requests.
    TooManyRequests,
    /// The owner has too many points in the queue.
    QuotaExceeded,
    /// A browser sent the request from another site's page.
    CrossSite,
    /// None of the media types in `Accept` can be served.
    NotAcceptable,
    /// The body is larger than the limit.
    BodyTooLarge,
    /// Path and query are longer than the limit.
    TargetTooLong,
    /// The header fields are larger than the limit.
    HeaderTooLarge,
    /// The body was not received in time.
    RequestTimeout,
    /// None of the requested bytes exist.
    RangeNotSatisfiable,
    /// No such route.
    NoSuchRoute,
    /// The route exists, the method does not.
    MethodNotAllowed,
    /// No such sweep, point or preset.
    NotFound,
    /// The node's motion was not recorded.
    NodeNotRecorded,
    /// The run kept spectra only, and none over this window.
    WindowNotKept,
    /// The point has no result, or not yet.
    NoResult,
    /// The run did not produce this table.
    NoSuchTable,
    /// The table was there and has reached its age.
    Expired,
    /// Storage has lost the table, or a part of it.
    Damaged,
    /// Storage has lost the table, and its point is computed again.
    Recomputing,
    /// The sweep's state does not allow the operation.
    Conflict,
    /// The `ETag` of the sweep is no longer that of `If-Match`.
    PreconditionFailed,
    /// The idempotency key was used with another request.
    IdempotencyKeyReused,
    /// The service cannot answer just now; try again.
    Unavailable,
    /// The service's disk is full.
    StorageFull,
    /// The service failed; its log has the reason under the request id.
    Internal,
}

impl ProblemKind {
    /// Every kind, for documentation.
    pub const ALL: &'static [ProblemKind] = &[
        ProblemKind::MalformedBody,
        ProblemKind::InvalidRequest,
        ProblemKind::TooMuchWork,
        ProblemKind::InvalidParameter,
        ProblemKind::UnsupportedMediaType,
        ProblemKind::Unauthorized,
        ProblemKind::Forbidden,
        ProblemKind::TooManyRequests,
        ProblemKind::QuotaExceeded,
        ProblemKind::CrossSite,
        ProblemKind::NotAcceptable,
        ProblemKind::BodyTooLarge,
        ProblemKind::TargetTooLong,
        ProblemKind::HeaderTooLarge,
        ProblemKind::RequestTimeout,
        ProblemKind::RangeNotSatisfiable,
        ProblemKind::NoSuchRoute,
        ProblemKind::MethodNotAllowed,
        ProblemKind::NotFound,
        ProblemKind::NodeNotRecorded,
        ProblemKind::WindowNotKept,
        ProblemKind::NoResult,
        ProblemKind::NoSuchTable,
        ProblemKind::Expired,
        ProblemKind::Damaged,
        ProblemKind::Recomputing,
        ProblemKind::Conflict,
        ProblemKind::PreconditionFailed,
        ProblemKind::IdempotencyKeyReused,
        ProblemKind::Unavailable,
        ProblemKind::StorageFull,
        ProblemKind::Internal,
    ];

    /// The last part of the type URI.
    pub fn slug(self) -> &'static str {
        self.describe().0
    }

    /// The type URI: stable, meant for programs to compare.
    pub fn uri(self) -> String {
        format!("urn:drillsweep:problem:{}", self.slug())
    }

    /// A short text for people.
    pub fn title(self) -> &'static str {
        self.describe().1
    }

    /// The HTTP status.
    pub fn status(self) -> u16 {
        self.describe().2
    }

    fn describe(self) -> (&'static str, &'static str, u16) {
        match self {
            ProblemKind::MalformedBody => ("malformed-body", "The body cannot be read", 400),
            ProblemKind::InvalidRequest => ("invalid-request", "The request cannot be simulated", 422),
            ProblemKind::TooMuchWork => ("too-much-work", "The request takes too long to prepare", 422),
            ProblemKind::InvalidParameter => ("invalid-parameter", "A parameter is not valid", 400),
            ProblemKind::UnsupportedMediaType => {
                ("unsupported-media-type", "The body's media type is not accepted", 415)
            }
            ProblemKind::Unauthorized => ("unauthorized", "A valid token is needed", 401),
            ProblemKind::Forbidden => ("forbidden", "The token does not allow this", 403),
            ProblemKind::TooManyRequests => ("too-many-requests", "Too many requests", 429),
            ProblemKind::QuotaExceeded => ("quota-exceeded", "Too many points in the queue", 429),
            ProblemKind::CrossSite => ("cross-site", "Requests from other sites are refused", 403),
            ProblemKind::NotAcceptable => ("not-acceptable", "No acceptable format", 406),
            ProblemKind::BodyTooLarge => ("body-too-large", "The body is too large", 413),
            ProblemKind::TargetTooLong => ("target-too-long", "Path and query are too long", 414),
            ProblemKind::HeaderTooLarge => ("header-too-large", "The header fields are too large", 431),
            ProblemKind::RequestTimeout => ("request-timeout", "The body was not received in time", 408),
            ProblemKind::RangeNotSatisfiable => {
                ("range-not-satisfiable", "The range is not satisfiable", 416)
            }
            ProblemKind::NoSuchRoute => ("no-such-route", "No such route", 404),
            ProblemKind::MethodNotAllowed => ("method-not-allowed", "Method not allowed", 405),
            ProblemKind::NotFound => ("not-found", "Not found", 404),
            ProblemKind::NodeNotRecorded => ("node-not-recorded", "The node was not recorded", 404),
            ProblemKind::WindowNotKept => ("window-not-kept", "No spectrum over this window was kept", 422),
            ProblemKind::NoResult => ("no-result", "The point has no result", 409),
            ProblemKind::NoSuchTable => ("no-such-table", "The run has no such table", 404),
            ProblemKind::Expired => ("expired", "The table has expired", 410),
            ProblemKind::Damaged => ("damaged", "The stored table is missing or damaged", 500),
            ProblemKind::Recomputing => ("recomputing", "The table is being recomputed", 503),
            ProblemKind::Conflict => ("conflict", "The sweep's state does not allow this", 409),
            ProblemKind::PreconditionFailed => {
                ("precondition-failed", "The sweep was changed since it was read", 412)
            }
            ProblemKind::IdempotencyKeyReused => {
                ("idempotency-key-reused", "The idempotency key belongs to another request", 422)
            }
            ProblemKind::Unavailable => ("unavailable", "Temporarily unavailable", 503),
            ProblemKind::StorageFull => ("storage-full", "Storage full", 507),
            ProblemKind::Internal => ("internal", "Internal error", 500),
        }
    }
}

/// A problem document (RFC 9457), served as `application/problem+json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct ProblemDetails {
    /// Stable URI of the kind of problem, for programs to compare.
    #[serde(rename = "type")]
    #[schema(example = "urn:drillsweep:problem:invalid-request")]
    pub type_uri: String,
    /// The kind of problem in words.
    pub title: String,
    /// The HTTP status.
    pub status: u16,
    /// Explanation of this occurrence.
    pub detail: String,
    /// Identifies this occurrence; the same id stands in the service's log.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instance: Option<String>,
    /// Every single problem found, at once.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<FieldProblem>,
    /// The state of the point, when the problem is that it has no result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<PointState>,
}

/// One thing that is wrong with a request.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct FieldProblem {
    /// JSON Pointer (RFC 6901) into the request's body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(example = "/axes/flow_rate/values/2")]
    pub pointer: Option<String>,
    /// Name of the path, query or header parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameter: Option<String>,
    /// Value that was given; absent if none was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub got: Option<Value>,
    /// Explanation of the problem, with the valid values.
    pub detail: String,
}

impl ProblemDetails {
    /// A problem of one kind, without single errors.
    pub fn new(kind: ProblemKind, detail: impl Into<String>) -> Self {
        ProblemDetails {
            type_uri: kind.uri(),
            title: kind.title().to_owned(),
            status: kind.status(),
            detail: detail.into(),
            instance: None,
            errors: Vec::new(),
            state: None,
        }
    }

    /// A body that is not JSON, or not of the documented form at the place of the JSON Pointer. A unit that does not fit there makes the request
    /// invalid, as in `set`, which is read once the scenario is known.
    pub fn malformed_body(pointer: String, error: &serde_json::Error) -> Self {
        let (message, position) =
            (error.to_string(), format!(" at line {} column {}", error.line(), error.column()));
        let (got, detail) = if error.is_data() {
            // The pointer has the place.
            let message = message.strip_suffix(&position).unwrap_or(&message);
            let problem = Problem::from_serde(String::new(), message);
            match serde_json::from_str(&problem.got) {
                Ok(got) => (Some(got), problem.message),
                Err(_) => (None, problem.to_string()),
            }
        } else {
            (None, format!("not JSON: {message}"))
        };
        let error = FieldProblem { pointer: Some(pointer), parameter: None, got, detail };
        if entry::is_refusal(&error.detail) {
            return Self::invalid_request(vec![error]);
        }
        // A problem of the whole body needs no place.
        let text = error.to_string();
        let text = text.strip_prefix(": ").unwrap_or(&text);
        let problem = ProblemDetails::new(ProblemKind::MalformedBody, text);
        ProblemDetails { errors: vec![error], ..problem }
    }

    /// A body that cannot be simulated, with everything that was found wrong with it.
    pub fn invalid_request(errors: Vec<FieldProblem>) -> Self {
        let detail = match errors.as_slice() {
            [only] => match &only.pointer {
                Some(pointer) => format!("{pointer}: {}", only.detail),
                None => only.detail.clone(),
            },
            all => format!("{} problems were found", all.len()),
        };
        ProblemDetails { errors, ..ProblemDetails::new(ProblemKind::InvalidRequest, detail) }
    }

    /// Shortens texts that repeat the request, so that no answer is as long as a hostile request.
    pub fn shorten(&mut self) {
        shorten(&mut self.detail, LONGEST_DETAIL);
        for error in &mut self.errors {
            shorten(&mut error.detail, LONGEST_DETAIL);
            if let Some(pointer) = &mut error.pointer {
                shorten(pointer, LONGEST_VALUE);
            }
            if error.got.as_ref().is_some_and(|got| got.to_string().len() > LONGEST_VALUE) {
                let mut text = error.got.take().map_or_else(String::new, |got| match got {
                    Value::String(text) => text,
                    other => other.to_string(),
                });
                shorten(&mut text, LONGEST_VALUE);
                error.got = Some(text.into());
            }
        }
    }

    /// A path, query or header parameter that is not valid.
    pub fn invalid_parameter(name: &str, got: Option<&str>, detail: impl Into<String>) -> Self {
        let detail = detail.into();
        let error = FieldProblem {
            pointer: None,
            parameter: Some(name.to_owned()),
            got: got.map(Into::into),
            detail: detail.clone(),
        };
        let detail = format!("{name}: {detail}");
        ProblemDetails { errors: vec![error], ..ProblemDetails::new(ProblemKind::InvalidParameter, detail) }
    }

    /// A query parameter that serde could not read, by its message.
    pub fn unreadable_parameter(name: &str, got: Option<&str>, message: &str) -> Self {
        let detail = Problem::from_serde(String::new(), message).message;
        Self::invalid_parameter(name, got, detail.replacen("no field", "no parameter", 1))
    }

    /// Problem of a name in `fields` that is no column of a table, with the names of the columns.
    pub fn no_such_column(table: &Table, name: &str) -> Self {
        let names: Vec<&str> = table.columns.keys().map(String::as_str).collect();
        let detail = format!("there is no such column; there are {}", names.join(", "));
        Self::invalid_parameter("fields", Some(name), detail)
    }
}

impl std::fmt::Display for ProblemDetails {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}: {}", self.title, self.detail)?;
        if self.errors.len() > 1 {
            for error in &self.errors {
                write!(formatter, "\n  {error}")?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for ProblemDetails {}

impl std::fmt::Display for FieldProblem {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(place) = self.pointer.as_ref().or(self.parameter.as_ref()) {
            write!(formatter, "{place}: ")?;
        }
        formatter.write_str(&self.detail)?;
        match &self.got {
            Some(got) => write!(formatter, " (got {got})"),
            None => Ok(()),
        }
    }
}

/// Bytes of a detail, and of a pointer or value that was given, in a problem document.
const LONGEST_DETAIL: usize = 20_000;
const LONGEST_VALUE: usize = 1_000;

/// Cuts a text to `most` bytes or somewhat less, with an ellipsis at its end.
fn shorten(text: &mut String, most: usize) {
    const ELLIPSIS: &str = "...";
    if text.len() > most {
        text.truncate(text.floor_char_boundary(most - ELLIPSIS.len()));
        text.push_str(ELLIPSIS);
    }
}

/// One member name as a token of a JSON Pointer (RFC 6901 section 3).
pub fn pointer_token(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_kind_has_its_own_uri() {
        let uris: HashSet<_> = ProblemKind::ALL.iter().map(|kind| kind.uri()).collect();
        assert_eq!(uris.len(), ProblemKind::ALL.len());
    }

    #[test]
    fn texts_of_a_problem_are_shorter_than_the_request() {
        let error = |got: Value| FieldProblem {
            pointer: Some(format!("/set/{}", "k".repeat(5_000))),
            parameter: None,
            got: Some(got),
            detail: format!("must not be {}", "\u{e4}".repeat(50_000)),
        };
        let errors =
            vec![error("\u{e4}".repeat(5_000).into()), error(vec![1; 5_000].into()), error(7.into())];
        let mut problem = ProblemDetails::invalid_request(errors);
        problem.shorten();
        for error in &problem.errors {
            assert!(error.detail.len() <= LONGEST_DETAIL && error.detail.ends_with("..."));
            assert!(error.pointer.as_ref().unwrap().len() <= LONGEST_VALUE);
        }
        let lengths = problem.errors.iter().map(|error| error.got.as_ref().unwrap().to_string().len());
        assert!(lengths.max() <= Some(LONGEST_VALUE + 2), "{problem:?}");
        assert_eq!(problem.errors[2].got, Some(7.into()));
    }

    #[test]
    fn pointer_tokens_are_escaped_as_rfc_6901_says() {
        // The examples of RFC 6901 section 5.
        assert_eq!(pointer_token("a/b"), "a~1b");
        assert_eq!(pointer_token("m~n"), "m~0n");
        assert_eq!(pointer_token("~1"), "~01");
    }
}
