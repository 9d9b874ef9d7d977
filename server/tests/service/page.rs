//! The web page and its sessions.

use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

use axum::body::Body;
use axum::http::{Method, Request, StatusCode, header};
use drillsweep_store::{NewToken, Store, TokenScope, TokenSecret};
use serde_json::{Value, json};
use tower::ServiceExt;

use crate::bench::{Answer, Bench, json_request};

async fn token(bench: &Bench, scope: TokenScope, lifetime_ms: Option<i64>) -> TokenSecret {
    let secret = TokenSecret::generate().unwrap();
    let token = NewToken { secret: &secret, owner: "anne", name: Some("rig 7"), scope, lifetime_ms };
    bench.store.create_token(&token).await.unwrap();
    secret
}

async fn log_in(bench: &Bench, token: &str) -> Answer {
    bench.post("/v1/session", json!({ "token": token })).await
}

/// The cookie of an answer, as a browser sends it back.
fn cookie(answer: &Answer) -> String {
    let cookie = answer.headers[header::SET_COOKIE].to_str().unwrap();
    cookie.split(';').next().unwrap().to_owned()
}

async fn send(
    bench: &Bench,
    cookie: &str,
    method: Method,
    path: &str,
    body: Value,
    site: Option<&str>,
) -> Answer {
    let mut request = json_request(method, path, body.to_string());
    request.headers_mut().insert(header::COOKIE, cookie.parse().unwrap());
    if let Some(site) = site {
        request.headers_mut().insert("sec-fetch-site", site.parse().unwrap());
    }
    bench.send(request).await
}

async fn read(bench: &Bench, cookie: &str) -> Answer {
    send(bench, cookie, Method::GET, "/v1/sweeps", json!({}), None).await
}

fn run() -> Value {
    json!({ "preset": "paper-200m-damped" })
}

#[tokio::test]
async fn a_browser_logs_in_by_a_token_and_out() {
    let bench = Bench::new().await;
    assert_eq!(bench.get("/v1/session").await.json(), json!({ "tokens_required": false }));
    let secret = token(&bench, TokenScope::Submit, None).await;
    assert_eq!(bench.get("/v1/session").await.json(), json!({ "tokens_required": true }));

    let answer = log_in(&bench, secret.expose()).await;
    assert_eq!(answer.status, StatusCode::CREATED);
    let session = answer.json();
    assert_eq!(session["owner"], "anne");
    assert_eq!(session["name"], "rig 7");
    assert_eq!(session["scope"], "submit");
    assert!(session["expires"].is_string());
    let set = answer.headers[header::SET_COOKIE].to_str().unwrap();
    for part in ["; HttpOnly", "; SameSite=Strict", "; Path=/", "; Max-Age="] {
        assert!(set.contains(part), "{set}");
    }
    assert!(!set.contains(secret.expose()) && !set.contains("Secure"), "{set}");

    let cookie = cookie(&answer);
    assert_eq!(read(&bench, &cookie).await.status, StatusCode::OK);
    let told = send(&bench, &cookie, Method::GET, "/v1/session", json!({}), None).await;
    assert_eq!(told.json(), session);
    let made = send(&bench, &cookie, Method::POST, "/v1/runs", run(), Some("same-origin")).await;
    assert_eq!(made.status, StatusCode::CREATED);
    assert_eq!(made.json()["owner"], "anne");

    let out = send(&bench, &cookie, Method::DELETE, "/v1/session", json!({}), Some("same-origin")).await;
    assert_eq!(out.status, StatusCode::NO_CONTENT);
    assert!(out.headers[header::SET_COOKIE].to_str().unwrap().contains("; Max-Age=0"));
    read(&bench, &cookie).await.problem(401, "unauthorized");
}

#[tokio::test]
async fn a_session_is_one_of_its_token_alone() {
    let bench = Bench::new().await;
    let reader = token(&bench, TokenScope::Read, None).await;
    let cookie = cookie(&log_in(&bench, reader.expose()).await);
    send(&bench, &cookie, Method::POST, "/v1/runs", run(), Some("same-origin"))
        .await
        .problem(403, "forbidden");
    bench.store.revoke_token(&reader.id()).await.unwrap();
    read(&bench, &cookie).await.problem(401, "unauthorized");
    // What is no token's text opens none, a session's own text among them.
    let text = cookie.split_once('=').unwrap().1;
    for wrong in ["", "x", text, reader.expose()] {
        log_in(&bench, wrong).await.problem(401, "unauthorized");
    }
    read(&bench, "drillsweep_session=dsw_0000000000000000000000000000000000000000")
        .await
        .problem(401, "unauthorized");
}

#[tokio::test]
async fn a_session_ends_with_its_token_or_after_thirty_days() {
    const HOUR: Duration = Duration::from_secs(3_600);
    let bench = Bench::new().await;
    let brief = token(&bench, TokenScope::Read, Some(HOUR.as_millis() as i64)).await;
    let lasting = token(&bench, TokenScope::Read, None).await;
    let mut secrets = Vec::new();
    for (token, seconds) in [(brief, 3_600), (lasting, 30 * 24 * 3_600)] {
        let answer = log_in(&bench, token.expose()).await;
        let set = answer.headers[header::SET_COOKIE].to_str().unwrap();
        let age = set.split("Max-Age=").nth(1).unwrap().split(';').next().unwrap().parse::<i64>().unwrap();
        assert!(age <= seconds && age > seconds - 600, "{set}");
        secrets.push(TokenSecret::parse(cookie(&answer).split_once('=').unwrap().1).unwrap());
    }
    let are_valid = async |store: &Store| {
        (
            store.session(&secrets[0]).await.unwrap().is_some(),
            store.session(&secrets[1]).await.unwrap().is_some(),
        )
    };
    assert_eq!(are_valid(&bench.store).await, (true, true));
    assert_eq!(are_valid(&bench.later(2 * HOUR).await).await, (false, true));
    let later = bench.later(31 * 24 * HOUR).await;
    assert_eq!(are_valid(&later).await, (false, false));
    // And what has expired is taken away: not even who believes that it is earlier finds it.
    later.collect_garbage(&drillsweep_server::RetentionConfig::default().policy, false).await.unwrap();
    assert_eq!(are_valid(&bench.store).await, (false, false));
}

#[tokio::test]
async fn pages_of_other_sites_change_nothing_by_the_cookie() {
    let bench = Bench::new().await;
    let secret = token(&bench, TokenScope::Submit, None).await;
    let cookie = cookie(&log_in(&bench, secret.expose()).await);
    for site in ["cross-site", "same-site"] {
        let answer = send(&bench, &cookie, Method::POST, "/v1/runs", run(), Some(site)).await;
        answer.problem(403, "cross-site");
    }
    // An older browser tells its page's origin.
    let mut request = json_request(Method::POST, "/v1/runs", run().to_string());
    request.headers_mut().insert(header::COOKIE, cookie.parse().unwrap());
    request.headers_mut().insert(header::ORIGIN, "https://elsewhere.example".parse().unwrap());
    request.headers_mut().insert(header::HOST, "drillsweep.example".parse().unwrap());
    bench.send(request).await.problem(403, "cross-site");
}

#[tokio::test]
async fn behind_https_the_cookie_goes_by_https_alone() {
    let bench = Bench::new().await;
    let secret = token(&bench, TokenScope::Read, None).await;
    let mut request =
        json_request(Method::POST, "/v1/session", json!({ "token": secret.expose() }).to_string());
    request.headers_mut().insert("x-forwarded-proto", "https".parse().unwrap());
    let answer = bench.send(request).await;
    assert!(answer.headers[header::SET_COOKIE].to_str().unwrap().ends_with("; Secure"));
}

#[tokio::test]
async fn the_page_and_its_modules_are_served_without_a_token() {
    let bench = Bench::new().await;
    token(&bench, TokenScope::Read, None).await;
    let page = bench.get("/").await;
    assert_eq!(page.status, StatusCode::OK);
    assert_eq!(page.headers[header::CONTENT_TYPE], "text/html; charset=utf-8");
    assert_eq!(page.headers[header::CACHE_CONTROL], "no-cache");
    let policy = page.headers[header::CONTENT_SECURITY_POLICY].to_str().unwrap();
    assert!(policy.contains("default-src 'none'") && policy.contains("script-src 'self'"), "{policy}");
    let text = page.text().to_owned();
    let main = text.split('"').find(|part| part.ends_with("/main.js")).expect("the page loads it");
    let folder = main.strip_suffix("main.js").unwrap();
    let mut waiting = ["main.js", "style.css", "vendor/swagger-ui-bundle.js"].map(str::to_owned).to_vec();
    let mut seen = Vec::new();
    while let Some(path) = waiting.pop() {
        if seen.contains(&path) {
            continue;
        }
        let answer = bench.get(&format!("{folder}{path}")).await;
        assert_eq!(answer.status, StatusCode::OK, "{path}");
        assert!(answer.headers[header::CACHE_CONTROL].to_str().unwrap().contains("immutable"));
        if path.ends_with(".js") && !path.starts_with("vendor/") {
            assert_eq!(answer.headers[header::CONTENT_TYPE], "text/javascript; charset=utf-8");
            // Modules name each other by relative paths.
            let text = answer.text().to_owned();
            let named = text.split('"').filter(|part| part.starts_with("./") || part.starts_with("../"));
            waiting.extend(named.map(|relative| resolve(&path, relative)));
        }
        seen.push(path);
    }
    assert!(seen.len() > 5, "{seen:?}");
    // The head says what each module imports, and then runs what has all of a view's modules come at once by that.
    let (said, preload) = (
        text.find("id=\"imports\"").unwrap(),
        text.find(&format!("<script src=\"{folder}preload.js\"")).unwrap(),
    );
    assert!(said < preload && preload < text.find("type=\"module\"").unwrap());
    let imports =
        text.split("id=\"imports\">").nth(1).and_then(|rest| rest.split("</script>").next()).unwrap();
    let imports: Value = serde_json::from_str(imports).unwrap();
    for module in seen.iter().filter(|path| path.ends_with(".js") && !path.starts_with("vendor/")) {
        let answer = bench.get(&format!("{folder}{module}")).await;
        let named = answer.text().split(" from \"").skip(1).filter_map(|rest| rest.split('"').next());
        for relative in named.filter(|path| path.starts_with('.')) {
            let imported = resolve(module, relative);
            let said = imports[module].as_array().unwrap();
            assert!(said.iter().any(|path| *path == imported), "{module} imports {imported}: {said:?}");
        }
    }
    // It knows by name the modules of the parts of views.
    let text_of = async |module: &str| bench.get(&format!("{folder}{module}")).await.text().to_owned();
    let preload = text_of("preload.js").await;
    let is_part =
        |path: &&str| (path.starts_with("sweep/") || path.starts_with("point/")) && path.ends_with(".js");
    let named: BTreeSet<String> = preload.split('"').filter(is_part).map(str::to_owned).collect();
    let mut imported = BTreeSet::new();
    for view in ["sweep/view.js", "point/view.js"] {
        let text = text_of(view).await;
        let parts = text.split("await import(\"").skip(1).filter_map(|rest| rest.split('"').next());
        imported.extend(parts.map(|relative| resolve(view, relative)));
    }
    assert!(imported.len() > 10, "{imported:?}");
    assert_eq!(named, imported);

    // What has a copy is told that it is still right; another version has no files here.
    let tag = page.headers[header::ETAG].clone();
    let again = Request::get("/").header(header::IF_NONE_MATCH, tag).body(Body::empty()).unwrap();
    assert_eq!(bench.send(again).await.status, StatusCode::NOT_MODIFIED);
    bench.get("/web/0000000000000000/main.js").await.problem(404, "no-such-route");
    bench.get(&format!("{folder}../Cargo.toml")).await.problem(404, "no-such-route");
    bench.get(&format!("{folder}index.html")).await.problem(404, "no-such-route");
}

/// A path from the page's folder, from one that is relative to a module.
fn resolve(module: &str, relative: &str) -> String {
    let mut path = Path::new(module).parent().unwrap().to_owned();
    for part in relative.split('/') {
        match part {
            "." => {}
            ".." => assert!(path.pop(), "{module} names {relative}"),
            name => path.push(name),
        }
    }
    path.to_str().unwrap().to_owned()
}

#[tokio::test]
async fn files_are_sent_as_the_client_takes_them() {
    let bench = Bench::new().await;
    let page = bench.get("/").await;
    let main =
        page.text().split('"').find(|part| part.ends_with("/main.js")).expect("the page loads it").to_owned();
    let as_is = bench.get(&main).await;
    assert!(!as_is.headers.contains_key(header::CONTENT_ENCODING));
    let send = async |accepted: &str| {
        bench
            .send(Request::get(&main).header(header::ACCEPT_ENCODING, accepted).body(Body::empty()).unwrap())
            .await
    };
    for refused in ["br", "gzip; q=0, identity", "gzip;q=0.0"] {
        assert!(!send(refused).await.headers.contains_key(header::CONTENT_ENCODING), "{refused}");
    }
    let compressed = send("br;q=1.0, gzip;q=0.8").await;
    assert_ne!(compressed.headers[header::ETAG], as_is.headers[header::ETAG], "other bytes");
    assert_eq!(compressed.headers[header::CONTENT_ENCODING], "gzip");
    let mut text = Vec::new();
    std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(&*compressed.body), &mut text).unwrap();
    assert_eq!(text, as_is.body);
}

#[test]
fn files_of_others_are_those_that_their_list_names() {
    use sha2::{Digest, Sha256};
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("web/vendor");
    let list: Value = serde_json::from_slice(&std::fs::read(folder.join("vendor.json")).unwrap()).unwrap();
    let mut named = vec!["vendor.json".to_owned(), "fetch.py".to_owned()];
    for package in list.as_array().unwrap() {
        let license = package["license"].as_str().unwrap();
        assert!(["MIT", "Apache-2.0"].contains(&license), "{license}");
        for (name, file) in package["files"].as_object().unwrap() {
            let digest = Sha256::digest(std::fs::read(folder.join(name)).unwrap());
            let digest: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
            assert_eq!(file["sha256"], digest, "{name}");
            named.push(name.clone());
        }
    }
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(named.contains(&name), "{name} is in no list");
    }
}

#[tokio::test]
async fn every_server_of_a_store_knows_a_session() {
    let bench = Bench::new().await;
    let secret = token(&bench, TokenScope::Submit, None).await;
    let cookie = cookie(&log_in(&bench, secret.expose()).await);
    let run = send(&bench, &cookie, Method::POST, "/v1/runs", run(), Some("same-origin")).await.json();
    let (_stop, stopping) = tokio::sync::watch::channel(false);
    let another =
        drillsweep_server::router(bench.store.clone(), drillsweep_server::Config::default(), stopping);
    // As a browser's EventSource asks, which can send nothing but cookies.
    let of_sweep = format!("/v1/sweeps/{}/events", run["sweep"].as_str().or(run["id"].as_str()).unwrap());
    let ask = |path: &str, cookie: Option<&str>| {
        let request = Request::get(path).header(header::ACCEPT, "text/event-stream");
        let request = match cookie {
            Some(cookie) => request.header(header::COOKIE, cookie),
            None => request,
        };
        another.clone().oneshot(request.body(Body::empty()).unwrap())
    };
    assert_eq!(ask(&of_sweep, None).await.unwrap().status(), StatusCode::UNAUTHORIZED);
    let stream = ask(&of_sweep, Some(&cookie)).await.unwrap();
    assert_eq!(stream.status(), StatusCode::OK);
    assert_eq!(stream.headers()[header::CONTENT_TYPE], "text/event-stream");
}
