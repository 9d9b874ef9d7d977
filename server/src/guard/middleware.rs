//! Middleware of all routes.

use std::any::Any;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, Response, StatusCode, Version, header};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::IntoResponse;
use drillsweep_api::{PROBLEM_MEDIA_TYPE, ProblemKind};
use headers::{ETag, HeaderMapExt, IfNoneMatch};
use tower::ServiceBuilder;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::predicate::{DefaultPredicate, NotForContentType, Predicate};
use tower_http::compression::{CompressionLayer, CompressionLevel};
use tower_http::csrf::{CsrfLayer, ProtectionError};
use tower_http::request_id::{MakeRequestId, PropagateRequestIdLayer, RequestId, SetRequestIdLayer};
use tower_http::trace::TraceLayer;
use tracing::Span;

use crate::answer::error::Error;
use crate::app::App;
use crate::guard::{auth, measure};
use crate::listen::{InReserve, Peer};

const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// Wraps the routes in, from the outside: request ids, spans, metrics, compression, `nosniff`, 304 for current copies, problem documents,
/// refusal of encodings, overlong requests and unclear hosts, panics, refusal of other sites' pages, the reserve, tokens and rates.
pub(crate) fn wrap(routes: Router, app: &App) -> Router {
    let worthwhile =
        DefaultPredicate::new().and(NotForContentType::const_new("application/vnd.apache.parquet"));
    routes.layer(
        ServiceBuilder::new()
            .layer(SetRequestIdLayer::new(REQUEST_ID, RequestIds))
            .layer(
                TraceLayer::new_for_http()
                    .make_span_with(span)
                    .on_request(())
                    .on_response(log_response)
                    .on_failure(()),
            )
            .layer(PropagateRequestIdLayer::new(REQUEST_ID))
            .layer(from_fn_with_state(app.clone(), measure::measure))
            .layer(
                CompressionLayer::new()
                    .quality(CompressionLevel::Fastest)
                    .compress_when(Worthwhile(worthwhile)),
            )
            .layer(from_fn(forbid_guessing))
            .layer(from_fn(answer_unchanged))
            .layer(from_fn(write_problems))
            .layer(from_fn(agree_on_encoding))
            .layer(from_fn(refuse_long_requests))
            .layer(from_fn(refuse_unclear_hosts))
            .layer(CatchPanicLayer::custom(answer_panic))
            .layer(CsrfLayer::new().with_rejection_response(refuse_other_sites))
            .layer(from_fn(keep_reserve))
            .layer(from_fn_with_state(app.clone(), auth::guard)),
    )
}

/// Ids in order of time (UUID version 7).
#[derive(Clone)]
struct RequestIds;

impl MakeRequestId for RequestIds {
    fn make_request_id<B>(&mut self, _: &axum::http::Request<B>) -> Option<RequestId> {
        uuid::Uuid::now_v7().to_string().parse().ok().map(RequestId::new)
    }
}

fn span(request: &Request) -> Span {
    let id = request.extensions().get::<RequestId>().and_then(|id| id.header_value().to_str().ok());
    tracing::info_span!(
        "request",
        request.id = id.unwrap_or_default(),
        http.method = %request.method(),
        http.path = request.uri().path(),
        http.status = tracing::field::Empty,
    )
}

fn log_response<B>(response: &Response<B>, latency: Duration, span: &Span) {
    span.record("http.status", response.status().as_u16());
    tracing::debug!(
        http.status = response.status().as_u16(),
        latency_ms = latency.as_secs_f64() * 1e3,
        "answered"
    );
}

/// Keeps browsers from guessing media types.
async fn forbid_guessing(request: Request, next: Next) -> Response<Body> {
    let mut response = next.run(request).await;
    response.headers_mut().insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    response
}

/// Marks answers to clients that refuse `identity`.
#[derive(Clone, Copy)]
struct MustBeEncoded;

/// Predicate of compression: answers that `P` accepts, and those that must be encoded.
#[derive(Clone, Copy)]
struct Worthwhile<P>(P);

impl<P: Predicate> Predicate for Worthwhile<P> {
    fn should_compress<B: axum::body::HttpBody>(&self, response: &Response<B>) -> bool {
        response.extensions().get::<MustBeEncoded>().is_some() || self.0.should_compress(response)
    }
}

/// Refuses requests that exclude both gzip and `identity` (RFC 9110 section 12.5.3) before any work. Requests that exclude `identity` alone
/// get no ranges, which are not encoded.
async fn agree_on_encoding(mut request: Request, next: Next) -> Response<Body> {
    let accepted = accepted_encodings(request.headers());
    let any = accepts(&accepted, &["*"]);
    if accepts(&accepted, &["identity"]).or(any).unwrap_or(true) {
        return next.run(request).await;
    }
    if !accepts(&accepted, &["gzip", "x-gzip"]).or(any).unwrap_or(false) {
        let detail = format!(
            "responses are encoded as gzip or identity, and Accept-Encoding accepts neither: {accepted}"
        );
        return Error::new(ProblemKind::NotAcceptable, detail).into_response();
    }
    request.headers_mut().remove(header::RANGE);
    let mut response = next.run(request).await;
    response.extensions_mut().insert(MustBeEncoded);
    response
}

/// True if `Accept-Encoding` accepts gzip.
pub(crate) fn takes_gzip(headers: &HeaderMap) -> bool {
    let accepted = accepted_encodings(headers);
    accepts(&accepted, &["gzip", "x-gzip"]).or(accepts(&accepted, &["*"])).unwrap_or(false)
}

fn accepted_encodings(headers: &HeaderMap) -> String {
    let fields = headers.get_all(header::ACCEPT_ENCODING).iter();
    let accepted: Vec<&str> = fields.filter_map(|value| value.to_str().ok()).collect();
    accepted.join(",")
}

/// True if an `Accept-Encoding` header accepts one of these encodings; `None` if it names none of them.
fn accepts(header: &str, names: &[&str]) -> Option<bool> {
    header.split(',').find_map(|entry| {
        let mut parts = entry.split(';').map(str::trim);
        let name = parts.next()?;
        names.iter().any(|wanted| wanted.eq_ignore_ascii_case(name)).then(|| {
            let weight = parts.find_map(|part| part.strip_prefix("q=").or_else(|| part.strip_prefix("Q=")));
            weight.and_then(|weight| weight.parse::<f64>().ok()).is_none_or(|weight| weight > 0.0)
        })
    })
}

/// Limits on a request's target and its header fields together \[bytes\], as in other servers.
const LONGEST_TARGET: usize = 8 * 1024;
const LONGEST_HEADER: usize = 32 * 1024;

/// Refuses requests with an overlong target or header.
async fn refuse_long_requests(request: Request, next: Next) -> Response<Body> {
    let target = request.uri().path_and_query().map_or(0, |target| target.as_str().len());
    let fields = request.headers().iter().map(|(name, value)| name.as_str().len() + value.len());
    let (kind, what, limit) = if target > LONGEST_TARGET {
        (ProblemKind::TargetTooLong, "the request's path and query", LONGEST_TARGET)
    } else if fields.sum::<usize>() > LONGEST_HEADER {
        (ProblemKind::HeaderTooLarge, "the request's header fields", LONGEST_HEADER)
    } else {
        return next.run(request).await;
    };
    Error::new(kind, format!("{what} have more than {limit} bytes")).into_response()
}

/// Refuses requests whose host is missing, duplicate, or different from that of the target (RFC 9112 section 3.2), since it decides which
/// callers are local.
async fn refuse_unclear_hosts(request: Request, next: Next) -> Response<Body> {
    let mut hosts = request.headers().get_all(header::HOST).iter();
    let is_clear = match (hosts.next(), hosts.next()) {
        (_, Some(_)) => false,
        (None, None) => request.version() < Version::HTTP_11,
        (Some(host), None) => {
            let authority = request.uri().authority();
            authority
                .is_none_or(|authority| host.as_bytes().eq_ignore_ascii_case(authority.as_str().as_bytes()))
        }
    };
    if is_clear || request.extensions().get::<Peer>().is_none() {
        return next.run(request).await;
    }
    let detail = "must be given once, the same as in the target if that has a host";
    Error::parameter("Host", None, detail).into_response()
}

/// Paths that connections in the reserve may request: cheap ones with the status of the service.
const LIGHT: [&str; 6] = ["/livez", "/readyz", "/v1/queue", "/v1/workers", "/v1/limits", "/v1/retention"];

/// Refuses other paths to connections in the reserve.
async fn keep_reserve(request: Request, next: Next) -> Response<Body> {
    if request.extensions().get::<InReserve>().is_some() && !LIGHT.contains(&request.uri().path()) {
        return Error::unavailable("all connections are in use").into_response();
    }
    next.run(request).await
}

/// Answers reads with 304 if the client has a current copy (RFC 9110 section 13.1.2).
async fn answer_unchanged(request: Request, next: Next) -> Response<Body> {
    let is_reading = matches!(*request.method(), Method::GET | Method::HEAD);
    let known = request.headers().typed_get::<IfNoneMatch>().filter(|_| is_reading);
    let response = next.run(request).await;
    let tag = response.headers().typed_get::<ETag>().filter(|_| response.status() == StatusCode::OK);
    if known.zip(tag).is_none_or(|(known, tag)| known.precondition_passes(&tag)) {
        return response;
    }
    let mut unchanged = StatusCode::NOT_MODIFIED.into_response();
    for name in [header::ETAG, header::CACHE_CONTROL, header::VARY] {
        if let Some(value) = response.headers().get(&name) {
            unchanged.headers_mut().insert(name, value.clone());
        }
    }
    unchanged
}

/// Writes the bodies of problems, with the request's id as `instance`.
async fn write_problems(request: Request, next: Next) -> Response<Body> {
    let id = request.extensions().get::<RequestId>().cloned();
    let mut response = next.run(request).await;
    let Some(error) = response.extensions_mut().remove::<Error>() else { return response };
    let mut problem = error.into_problem();
    problem.shorten();
    problem.instance =
        id.and_then(|id| Some(format!("urn:drillsweep:request:{}", id.header_value().to_str().ok()?)));
    match serde_json::to_vec(&problem) {
        Ok(body) => {
            let headers = response.headers_mut();
            headers.remove(header::CONTENT_LENGTH);
            headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(PROBLEM_MEDIA_TYPE));
            *response.body_mut() = Body::from(body);
        }
        Err(reason) => tracing::error!(%reason, "a problem could not be written"),
    }
    response
}

// Signature of the layer.
#[expect(clippy::needless_pass_by_value)]
fn answer_panic(panic: Box<dyn Any + Send>) -> Response<Body> {
    let text = panic.downcast_ref::<&str>().copied().or(panic.downcast_ref::<String>().map(String::as_str));
    Error::internal(text.unwrap_or("a panic without a message")).into_response()
}

// Signature of the layer.
#[expect(clippy::needless_pass_by_value)]
fn refuse_other_sites(error: ProtectionError) -> Response<Body> {
    tracing::warn!(reason = ?error.kind(), "a page of another site sent a request");
    Error::new(ProblemKind::CrossSite, "the request comes from a page of another site").into_response()
}

#[cfg(test)]
mod tests {
    use axum::body::to_bytes;
    use axum::http::Request;
    use axum::routing::{get, patch};
    use tower::ServiceExt as _;

    use super::*;

    /// RFC 9110 section 13.2.1: a precondition is ignored if the answer without it is no success; sections 15.3.2 and 15.3.7: a copy is
    /// neither a created resource nor a part of one.
    #[tokio::test]
    async fn only_an_answer_with_the_whole_content_is_unchanged() {
        for status in [200, 201, 202, 206, 404, 409, 412, 500] {
            let status = StatusCode::from_u16(status).unwrap();
            let answer = move || async move { (status, [(header::ETAG, "\"copy\"")], "content") };
            let routes = Router::new().route("/", get(answer)).layer(from_fn(answer_unchanged));
            for known in ["\"copy\"", "*"] {
                let request =
                    Request::get("/").header(header::IF_NONE_MATCH, known).body(Body::empty()).unwrap();
                let response = routes.clone().oneshot(request).await.unwrap();
                let expected = if status == StatusCode::OK { StatusCode::NOT_MODIFIED } else { status };
                assert_eq!(response.status(), expected);
                assert_eq!(response.headers()[header::ETAG], "\"copy\"");
                let body = to_bytes(response.into_body(), 100).await.unwrap();
                assert_eq!(body.is_empty(), status == StatusCode::OK, "{status}");
            }
        }
        let answer = async || ([(header::ETAG, "\"copy\"")], "changed");
        let routes = Router::new().route("/", patch(answer)).layer(from_fn(answer_unchanged));
        let request = Request::patch("/").header(header::IF_NONE_MATCH, "\"copy\"").body(Body::empty());
        let response = routes.oneshot(request.unwrap()).await.unwrap();
        assert_eq!(response.status(), StatusCode::OK, "what has changed something is no copy");
    }

    /// RFC 9112 section 3.2: of HTTP/1.1 on, a request has exactly one host, that of an absolute target.
    #[tokio::test]
    async fn a_request_has_one_host_that_of_its_target() {
        let routes = Router::new().fallback(async || "content").layer(from_fn(refuse_unclear_hosts));
        for (version, target, hosts, status) in [
            (Version::HTTP_11, "/", &["a"][..], 200),
            (Version::HTTP_11, "http://A:80/", &["a:80"], 200),
            (Version::HTTP_11, "http://b/", &["a"], 400),
            (Version::HTTP_11, "/", &["a", "a"], 400),
            (Version::HTTP_11, "/", &[], 400),
            (Version::HTTP_10, "/", &[], 200),
            (Version::HTTP_10, "/", &["a", "a"], 400),
        ] {
            let request = Request::get(target).version(version).extension(Peer(([127, 0, 0, 1], 80).into()));
            let request = hosts.iter().fold(request, |request, host| request.header(header::HOST, *host));
            let response = routes.clone().oneshot(request.body(Body::empty()).unwrap()).await.unwrap();
            assert_eq!(response.status(), status, "{version:?} {target} {hosts:?}");
        }
    }

    #[tokio::test]
    async fn a_request_of_the_longest_target_and_header_is_admitted_and_one_byte_more_is_not() {
        let routes = Router::new().fallback(async || "content").layer(from_fn(refuse_long_requests));
        let status = async |target: usize, header: usize| {
            let request = Request::get(format!("/{}", "x".repeat(target - 1)))
                .header("x-one", "1")
                .header("x-padding", "x".repeat(header - "x-one1x-padding".len()));
            routes.clone().oneshot(request.body(Body::empty()).unwrap()).await.unwrap().status().as_u16()
        };
        assert_eq!(status(8 * 1024, 32 * 1024).await, 200);
        assert_eq!(status(8 * 1024 + 1, 32 * 1024).await, 414);
        assert_eq!(status(8 * 1024, 32 * 1024 + 1).await, 431);
    }

    #[tokio::test]
    async fn a_panic_is_a_failure_of_the_service_whose_text_is_not_sent() {
        let panicking = async || -> &'static str { panic!("secret") };
        let routes = Router::new().route("/", get(panicking)).layer(
            ServiceBuilder::new().layer(from_fn(write_problems)).layer(CatchPanicLayer::custom(answer_panic)),
        );
        let response = routes.oneshot(Request::get("/").body(Body::empty()).unwrap()).await.unwrap();
        assert_eq!(response.status(), StatusCode::INTERNAL_SERVER_ERROR);
        let body = to_bytes(response.into_body(), 1_000).await.unwrap();
        let problem: serde_json::Value = serde_json::from_slice(&body).unwrap();
        assert_eq!(problem["type"], "urn:drillsweep:problem:internal");
        assert!(!problem.to_string().contains("secret"), "{problem}");
    }
}
