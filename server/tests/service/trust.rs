//! Authorization, rate limits, and what operators see.

use std::num::NonZeroU32;
use std::time::Duration;

use axum::body::Body;
use axum::http::{Method, Request, StatusCode, header};
use axum::response::Response;
use drillsweep_api::PHYSICS_VERSION;
use drillsweep_server::{Config, Listeners, OwnerLimits, ServeError, serve};
use drillsweep_store::{NewToken, TokenScope, TokenSecret};
use futures::StreamExt as _;
use http_body_util::BodyExt as _;
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;

use crate::bench::{Answer, Bench, json_request};

pub(crate) async fn token(bench: &Bench, owner: &str, scope: TokenScope) -> TokenSecret {
    let secret = TokenSecret::generate().unwrap();
    let token = NewToken { secret: &secret, owner, name: None, scope, lifetime_ms: None };
    bench.store.create_token(&token).await.unwrap();
    secret
}

pub(crate) async fn send(
    bench: &Bench,
    token: &TokenSecret,
    method: Method,
    path: &str,
    body: Value,
) -> Answer {
    let mut request = json_request(method, path, body.to_string());
    let value = format!("Bearer {}", token.expose()).parse().unwrap();
    request.headers_mut().insert(header::AUTHORIZATION, value);
    bench.send(request).await
}

async fn submit(bench: &Bench, token: &TokenSecret, body: Value) -> Answer {
    send(bench, token, Method::POST, "/v1/sweeps", body).await
}

#[tokio::test]
async fn once_a_token_exists_every_request_needs_one() {
    let bench = Bench::new().await;
    assert_eq!(bench.get("/v1/sweeps").await.status, StatusCode::OK);
    let reader = token(&bench, "anne", TokenScope::Read).await;
    for path in ["/v1/sweeps", "/v1/limits", "/v1/sweeps/x/table", "/nowhere"] {
        let answer = bench.get(path).await;
        answer.problem(401, "unauthorized");
        assert_eq!(answer.headers[header::WWW_AUTHENTICATE], "Bearer");
    }
    for path in ["/livez", "/readyz", "/openapi.json"] {
        assert_eq!(bench.get(path).await.status, StatusCode::OK, "{path}");
    }
    for value in ["Bearer", "Bearer ", "Basic YTpi", "bearer dsw_0000000000000000000000000000000000000000"] {
        let request =
            Request::get("/v1/sweeps").header(header::AUTHORIZATION, value).body(Body::empty()).unwrap();
        bench.send(request).await.problem(401, "unauthorized");
    }
    assert!(bench.store.tokens().await.unwrap()[0].last_used.is_none());
    assert_eq!(send(&bench, &reader, Method::GET, "/v1/sweeps", json!({})).await.status, StatusCode::OK);
    assert!(bench.store.tokens().await.unwrap()[0].last_used.is_some());
    bench.store.revoke_token(&reader.id()).await.unwrap();
    send(&bench, &reader, Method::GET, "/v1/sweeps", json!({})).await.problem(401, "unauthorized");
    // Without a valid token left, the service is closed, not open again.
    bench.get("/v1/sweeps").await.problem(401, "unauthorized");
}

#[tokio::test]
async fn a_stream_of_events_ends_with_its_token() {
    async fn is_ended(stream: Response) {
        let all = stream.into_body().collect();
        tokio::time::timeout(Duration::from_secs(60), all).await.expect("it ends").expect("in good order");
    }
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.02]}}})).await;
    let of_sweep = format!("/v1/sweeps/{id}/events");
    // Of somebody on this machine, who needs a token once there is one.
    let local = bench.open(&of_sweep).await;
    assert_eq!(local.status(), StatusCode::OK);
    let (reader, other) =
        (token(&bench, "anne", TokenScope::Read).await, token(&bench, "bob", TokenScope::Read).await);
    let of = async |token: &TokenSecret| {
        let value = format!("Bearer {}", token.expose());
        let request =
            Request::get(&of_sweep).header(header::AUTHORIZATION, value).body(Body::empty()).unwrap();
        let stream = bench.begin(request).await;
        assert_eq!(stream.status(), StatusCode::OK);
        stream
    };
    let revoked = of(&reader).await;
    let mut kept = of(&other).await.into_body().into_data_stream();
    bench.store.revoke_token(&reader.id()).await.unwrap();
    tokio::join!(is_ended(local), is_ended(revoked));

    // One that still holds goes on to the end of its sweep.
    assert_eq!(send(&bench, &other, Method::GET, "/v1/sweeps", json!({})).await.status, StatusCode::OK);
    bench.succeed().await;
    let mut text = String::new();
    while let Some(piece) = kept.next().await {
        text.push_str(std::str::from_utf8(&piece.unwrap()).unwrap());
    }
    assert!(text.contains(r#""state":"completed""#), "{text}");
}

#[tokio::test]
async fn a_token_allows_its_scope_on_its_owners_sweeps() {
    let bench = Bench::new().await;
    let anne = token(&bench, "anne", TokenScope::Submit).await;
    let bob = token(&bench, "bob", TokenScope::Submit).await;
    let reader = token(&bench, "bob", TokenScope::Read).await;
    let admin = token(&bench, "root", TokenScope::Admin).await;
    let body = json!({"preset": "paper-200m"});
    submit(&bench, &reader, body.clone()).await.problem(403, "forbidden");
    let sweep = submit(&bench, &anne, body.clone()).await.json();
    assert_eq!(sweep["owner"], "anne");
    let cancel = format!("/v1/sweeps/{}/cancel", sweep["id"].as_str().unwrap());
    let show = format!("/v1/sweeps/{}", sweep["id"].as_str().unwrap());
    assert_eq!(send(&bench, &reader, Method::GET, &show, json!({})).await.json()["owner"], "anne");
    send(&bench, &bob, Method::POST, &cancel, json!({})).await.problem(403, "forbidden");
    send(&bench, &reader, Method::POST, &cancel, json!({})).await.problem(403, "forbidden");
    // An id in another spelling is the same id.
    let digit = cancel.as_bytes()[11];
    let spelt = cancel.replacen(digit as char, &format!("%{digit:02x}"), 1);
    assert_ne!(spelt, cancel);
    send(&bench, &bob, Method::POST, &spelt.replace("/v%31", "/v1"), json!({}))
        .await
        .problem(403, "forbidden");
    assert_eq!(send(&bench, &anne, Method::POST, &cancel, json!({})).await.json()["state"], "cancelled");
    assert_eq!(send(&bench, &admin, Method::POST, &cancel, json!({})).await.status, StatusCode::OK);

    let for_bob = json!({"preset": "paper-200m", "owner": "bob"});
    submit(&bench, &anne, for_bob.clone()).await.problem(403, "forbidden");
    assert_eq!(submit(&bench, &admin, for_bob.clone()).await.json()["owner"], "bob");
    assert_eq!(submit(&bench, &bob, for_bob).await.json()["owner"], "bob");
}

#[tokio::test]
async fn without_tokens_names_from_elsewhere_are_refused() {
    let bench = Bench::new().await;
    let with_host =
        |host: &str| Request::get("/v1/sweeps").header(header::HOST, host).body(Body::empty()).unwrap();
    bench.send(with_host("rebound.example.com:7340")).await.problem(403, "cross-site");
    assert_eq!(bench.send(with_host("127.0.0.1:7340")).await.status, StatusCode::OK);
}

#[tokio::test]
async fn an_owner_beyond_its_rate_gets_a_retry_after() {
    let one = NonZeroU32::new(1).unwrap();
    let limits =
        OwnerLimits { requests_per_second: one, request_burst: NonZeroU32::new(3).unwrap(), open_points: 2 };
    let bench = Bench::with(Config { owner_limits: limits, ..Config::default() }).await;
    let anne = token(&bench, "anne", TokenScope::Read).await;
    let bob = token(&bench, "bob", TokenScope::Admin).await;
    let mut refused = None;
    for _ in 0..5 {
        let answer = send(&bench, &anne, Method::GET, "/v1/limits", json!({})).await;
        if answer.status == StatusCode::TOO_MANY_REQUESTS {
            refused = Some(answer);
        }
    }
    let refused = refused.expect("five requests at once are more than three");
    refused.problem(429, "too-many-requests");
    assert_eq!(refused.headers[header::RETRY_AFTER], "1");
    let limits = send(&bench, &bob, Method::GET, "/v1/limits", json!({})).await.json();
    assert_eq!((&limits["request_burst"], &limits["open_points_per_owner"]), (&json!(3), &json!(2)));

    let three = json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.02, 0.03]}}});
    let refused = submit(&bench, &bob, three).await;
    let problem = refused.problem(429, "quota-exceeded");
    assert!(problem["detail"].as_str().unwrap().contains("the 2 allowed"), "{problem}");
    assert!(refused.headers.contains_key(header::RETRY_AFTER));
    assert_eq!(submit(&bench, &bob, json!({"preset": "paper-200m"})).await.status, StatusCode::CREATED);
}

#[tokio::test]
async fn the_service_does_not_listen_to_others_without_a_token() {
    let bench = Bench::new().await;
    let listeners = async || Listeners { api: TcpListener::bind("0.0.0.0:0").await.unwrap(), metrics: None };
    let refused = serve(listeners().await, bench.store.clone(), Config::default(), async {}).await;
    assert!(matches!(refused, Err(ServeError::OpenToOthers(_))), "{refused:?}");
    let secret = token(&bench, "anne", TokenScope::Read).await;
    serve(listeners().await, bench.store.clone(), Config::default(), async {}).await.unwrap();
    bench.store.revoke_token(&secret.id()).await.unwrap();
    let refused = serve(listeners().await, bench.store.clone(), Config::default(), async {}).await;
    assert!(matches!(refused, Err(ServeError::OpenToOthers(_))), "{refused:?}");
}

#[tokio::test]
async fn metrics_have_a_listener_of_their_own() {
    let bench = Bench::new().await;
    bench.submit(json!({"preset": "paper-200m", "axes": {"flow_rate": {"values": [0.01, 0.04]}}})).await;
    bench.diverge().await;
    bench.succeed().await;
    // Computed anew, it comes out otherwise.
    let run = json!({"preset": "paper-200m", "set": {"mud.flow_rate": 0.04}});
    let refreshed = bench.post("/v1/sweeps?cache=refresh", run).await.json();
    bench.succeed_with(2e-9).await;
    let path = format!("/v1/sweeps/{}/points/1", refreshed["id"].as_str().unwrap());
    let point = bench.get(&path).await.json();
    let told = json!({"differs": "summary", "earlier": {"version": "bench"}});
    assert_eq!(point["provenance"]["disagreement"], told);
    bench.submit(json!({"preset": "paper-200m", "set": {"mud.flow_rate": 0.05}})).await;
    let (api, metrics) =
        (TcpListener::bind("127.0.0.1:0").await.unwrap(), TcpListener::bind("127.0.0.1:0").await.unwrap());
    let (api_address, metrics_address) = (api.local_addr().unwrap(), metrics.local_addr().unwrap());
    let (stop, stopped) = oneshot::channel::<()>();
    let listeners = Listeners { api, metrics: Some(metrics) };
    let shutdown = async {
        let _ = stopped.await;
    };
    let service = tokio::spawn(serve(listeners, bench.store.clone(), Config::default(), shutdown));
    let get = async |address, path: &str| {
        let mut connection = TcpStream::connect(address).await.unwrap();
        let request = format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        connection.write_all(request.as_bytes()).await.unwrap();
        let mut answer = String::new();
        connection.read_to_string(&mut answer).await.unwrap();
        answer
    };
    assert!(get(api_address, "/metrics").await.starts_with("HTTP/1.1 404"));
    get(api_address, "/v1/sweeps/made-up-id").await;
    let text = get(metrics_address, "/metrics").await;
    let version = env!("CARGO_PKG_VERSION");
    for line in [
        "drillsweep_work{state=\"queued\"} 1",
        "drillsweep_points{state=\"failed\"} 1",
        "drillsweep_sweeps 3",
        "drillsweep_results_that_disagree 1",
        "drillsweep_connections 0",
        "drillsweep_lane_waiting{lane=\"expansions\"} 0",
        "drillsweep_lane_refused_total{lane=\"bodies\"} 0",
        "drillsweep_tokens_refused_total 0",
        &format!("drillsweep_build_info{{version=\"{version}\",physics_version=\"{PHYSICS_VERSION}\"}} 1"),
        "drillsweep_http_request_duration_seconds_count{method=\"GET\",route=\"/v1/sweeps/{id}\",status=\"404\"} 1",
        "drillsweep_http_request_duration_seconds_count{method=\"GET\",route=\"none\",status=\"404\"} 1",
    ] {
        assert!(text.lines().any(|found| found == line), "{line} in\n{text}");
    }
    assert!(!text.contains("made-up-id"));
    let value = |name: &str| -> f64 {
        let line = text.lines().find(|line| line.starts_with(name)).unwrap();
        line.rsplit(' ').next().unwrap().parse().unwrap()
    };
    // This process: some megabytes, some files, and it has begun within the hour.
    assert!((1e6..1e10).contains(&value("process_resident_memory_bytes ")), "{text}");
    assert!(value("process_open_fds ") >= 3.0 && value("process_cpu_seconds_total ") > 0.0);
    let age = jiff::Timestamp::now().as_second() as f64 - value("process_start_time_seconds ");
    assert!((-2.0..3_600.0).contains(&age), "{age}");
    stop.send(()).unwrap();
    service.await.unwrap().unwrap();
}
