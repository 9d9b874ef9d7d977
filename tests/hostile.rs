//! Malformed, huge and hostile input over the network: refused with a problem that says why, and the server lives.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::time::Duration;

use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::{Config, TestRunner};
use serde_json::{Value, json};
use ureq::http::Response;
use ureq::{Agent, Body};

use crate::{PATIENCE, Process, completed, get, listen, submit, wait};

/// Texts that have broken other services.
const NASTY: [&str; 24] = [
    "",
    ".",
    "..",
    "../../etc/passwd",
    "..%2f..%2fetc%2fpasswd",
    "/etc/passwd",
    "\\..\\..\\windows",
    "a\0b",
    "' OR 1=1 --",
    "\"; DROP TABLE sweep; --",
    "%00",
    "%",
    "{}",
    "[]",
    "null",
    "NaN",
    "inf",
    "-1",
    "0",
    "1e309",
    "18446744073709551616",
    "99999999999999999999999999",
    "\u{202e}\u{feff}\u{1f469}\u{200d}\u{1f680}",
    "\r\nx-injected: 1",
];

/// Nasty, arbitrary or long.
fn text() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => select(&NASTY[..]).prop_map(str::to_owned),
        2 => any::<String>(),
        1 => any::<f64>().prop_map(|number| number.to_string()),
        1 => (1..2_000_usize).prop_map(|length| "x".repeat(length)),
    ]
}

/// Any JSON, small or deep or with numbers at the ends of what can be written.
fn anything() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        select(vec![0.0, -1.0, 1e-300, 1e300, f64::MAX, f64::MIN_POSITIVE, 4_294_967_295.0])
            .prop_map(Value::from),
        text().prop_map(Value::from),
    ];
    leaf.prop_recursive(6, 40, 6, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..6).prop_map(Value::from),
            prop::collection::hash_map(text(), inner, 0..4)
                .prop_map(|members| Value::Object(members.into_iter().collect())),
        ]
    })
}

/// Everything that a request may have, so that any part of it can be spoiled.
fn full_request() -> Value {
    let preset: Value =
        serde_json::from_str(&drillsweep_scenario::preset("paper-200m").unwrap().to_json()).unwrap();
    json!({
        "name": "hostile",
        "owner": "somebody",
        "priority": 3,
        "scenario": preset,
        "set": {"duration": 60, "string.sections[1].count": 9, "mesh": {"drillpipe": 1.5}},
        "axes": {
            "flow_rate": {"values": [0.01, 0.02]},
            "mud_density": {"from": 1200, "to": 2100, "count": 4, "scale": "log"},
        },
    })
}

/// The pointers of all values in a document.
fn pointers(value: &Value, here: &str, found: &mut Vec<String>) {
    found.push(here.to_owned());
    match value {
        Value::Object(members) => {
            for (name, inner) in members {
                let name = name.replace('~', "~0").replace('/', "~1");
                pointers(inner, &format!("{here}/{name}"), found);
            }
        }
        Value::Array(entries) => {
            for (index, inner) in entries.iter().enumerate() {
                pointers(inner, &format!("{here}/{index}"), found);
            }
        }
        _ => {}
    }
}

/// A full request with one to three of its values or names replaced.
fn spoiled_request() -> impl Strategy<Value = Value> {
    let change = (any::<Index>(), anything(), prop::option::weighted(0.3, text()));
    prop::collection::vec(change, 1..4).prop_map(|changes| {
        let mut request = full_request();
        for (place, value, name) in changes {
            let mut places = Vec::new();
            pointers(&request, "", &mut places);
            let place: &String = place.get(&places);
            let target = request.pointer_mut(place).unwrap();
            match (target, name) {
                (Value::Object(members), Some(name)) => {
                    members.insert(name, value);
                }
                (target, _) => *target = value,
            }
        }
        request
    })
}

fn percent_encoded(text: &str) -> String {
    text.bytes().map(|byte| format!("%{byte:02X}")).collect()
}

fn agent() -> Agent {
    // A request that is not answered in a minute counts as one that hangs.
    let config =
        Agent::config_builder().http_status_as_error(false).timeout_global(Some(Duration::from_secs(60)));
    config.build().into()
}

/// An answer is a success, or a problem that says what is wrong with the request; never a failure of the service.
fn check(mut response: Response<Body>) -> Result<u16, TestCaseError> {
    let status = response.status().as_u16();
    let body = response.body_mut().read_to_string().unwrap_or_default();
    if (200..300).contains(&status) {
        return Ok(status);
    }
    prop_assert!((400..500).contains(&status), "{status}: {body}");
    let problem: Value =
        serde_json::from_str(&body).map_err(|_| TestCaseError::fail(format!("{status}: {body}")))?;
    prop_assert_eq!(&problem["status"], &json!(status));
    prop_assert!(problem["detail"].as_str().is_some_and(|detail| !detail.is_empty()), "{}", problem);
    prop_assert!(
        !body.contains("SELECT") && !body.contains("sqlx") && !body.contains("panicked"),
        "{}",
        body
    );
    Ok(status)
}

fn runner(cases: u32) -> TestRunner {
    TestRunner::new(Config { cases, failure_persistence: None, ..Config::default() })
}

/// Peak memory of a process \[MiB\].
fn peak_memory(process: &Process) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{}/status", process.0.id())).unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() / 1024
}

/// No limit on requests: it is the requests themselves that are to be judged.
const UNLIMITED: [&str; 4] = ["--requests-per-second", "1000000", "--request-burst", "1000000"];

fn server(data: &Path) -> (Process, String) {
    listen(data, &[&["serve"][..], &UNLIMITED].concat())
}

#[test]
fn spoiled_requests_are_refused_with_reasons() {
    let data = tempfile::tempdir().unwrap();
    let (process, server) = server(data.path());
    let agent = agent();
    let url = format!("{server}/v1/sweeps?dry_run=true");
    assert_eq!(
        check(agent.post(&url).send_json(full_request()).unwrap()).unwrap(),
        200,
        "unspoiled it is valid"
    );
    let outcome = runner(400).run(&spoiled_request(), |request| {
        let answer = agent.post(&url).send_json(&request);
        check(answer.map_err(|error| TestCaseError::fail(error.to_string()))?)?;
        Ok(())
    });
    outcome.unwrap();
    let peak = peak_memory(&process);
    assert!(peak < 1024, "{peak} MiB for requests of some kilobytes");
}

/// Processor time that a process has taken.
fn processor_time(process: &Process) -> Duration {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", process.0.id())).unwrap();
    // The name of the program, in parentheses, may have spaces.
    let fields: Vec<&str> = stat.rsplit_once(')').unwrap().1.split_whitespace().collect();
    let ticks: u64 = fields[11..13].iter().map(|ticks| ticks.parse::<u64>().unwrap()).sum();
    // A tick is a hundredth of a second for user programs, whatever the kernel's own are (proc(5)).
    Duration::from_millis(10 * ticks)
}

/// Texts of a request in which one list, map or text is so many times as large.
fn grown(request: &Value, place: &str, times: usize) -> String {
    const MARK: &str = "the place that grows";
    let mut rest = request.clone();
    let grown = match std::mem::replace(rest.pointer_mut(place).unwrap(), MARK.into()) {
        Value::String(text) => json!(text.repeat(times)).to_string(),
        Value::Array(entries) => {
            let entries: Vec<String> = entries.iter().map(Value::to_string).collect();
            format!("[{}]", vec![entries.join(","); times].join(","))
        }
        Value::Object(members) => {
            let value = members.values().next().map_or_else(|| "1".to_owned(), Value::to_string);
            let added = (0..times).map(|number| format!("\"k{number}\":{value}"));
            let members = members.iter().map(|(name, value)| format!("{}:{value}", json!(name)));
            format!("{{{}}}", members.chain(added).collect::<Vec<_>>().join(","))
        }
        other => panic!("{other} does not grow"),
    };
    rest.to_string().replace(&json!(MARK).to_string(), &grown)
}

/// Largest memory of a server, whatever is requested \[MiB\].
const MOST_MEMORY: u64 = 300;

/// Largest processor time of a request: the deadline of an expansion, and the work before and after it.
const MOST_TIME: Duration = Duration::from_secs(8);

#[test]
fn requests_of_any_size_take_bounded_time_and_memory() {
    let data = tempfile::tempdir().unwrap();
    let (process, server) = server(data.path());
    let agent = agent();
    let url = format!("{server}/v1/sweeps?dry_run=true");
    let mut full = full_request();
    full["tags"] = json!(["a"]);
    full["set"]["recording.nodes"] = json!([{"node": 3}]);
    full["scenario"]["recording"]["snapshots"] = json!({"rate_hz": 25.0, "nodes": [{"node": 3}]});
    let listed = json!({"preset": "paper-200m", "design": "list", "points": [{"flow_rate": 0.01}]});
    let mut bodies = Vec::new();
    for request in [full, listed] {
        let mut places = Vec::new();
        pointers(&request, "", &mut places);
        places.retain(|place| {
            let value = request.pointer(place).unwrap();
            value.is_array() || value.is_object() || value.is_string()
        });
        bodies.extend(places.into_iter().flat_map(|place| {
            let request = request.clone();
            [10, 1_000, 100_000].map(move |times| {
                let name = format!("{place} x {times}");
                (
                    name,
                    Box::new({
                        let (request, place) = (request.clone(), place.clone());
                        move || grown(&request, &place, times)
                    }) as Box<dyn Fn() -> String>,
                )
            })
        }));
    }
    let of = |before: &'static str, entry: &'static str, number: usize, after: &'static str| {
        let body = move || format!("{before}{}{after}", vec![entry; number].join(","));
        (format!("{number} {entry}"), Box::new(body) as Box<dyn Fn() -> String>)
    };
    bodies.extend([
        of(r#"{"preset":"paper-200m","design":"list","points":["#, "{}", 5_000_000, "]}"),
        of(r#"{"preset":"paper-200m","axes":{"flow_rate":{"values":["#, "1", 8_000_000, "]}}}"),
        of(r#"{"preset":"paper-200m","set":{"well.survey":["#, "1", 8_000_000, "]}}"),
        of(r#"{"preset":"paper-200m","set":{"well.survey":["#, r#"{"a":1}"#, 2_000_000, "]}}"),
    ]);
    for (name, body) in &bodies {
        let before = processor_time(&process);
        let answer = agent.post(&url).content_type("application/json").send(body());
        // The server closes on a body that is too large: the rest of it is not taken.
        let status = answer.map_or(413, |answer| check(answer).unwrap());
        let took = processor_time(&process) - before;
        assert!(took < MOST_TIME, "{name}: {took:?} of processor time for the answer {status}");
        let peak = peak_memory(&process);
        assert!(peak < MOST_MEMORY, "{name}: {peak} MiB");
    }
    // The largest that are valid, at once.
    let grid = json!({"preset": "paper-200m", "axes": {
        "flow_rate": {"from": 0.01, "to": 0.06, "count": 1_000},
        "mud_density": {"from": 1200, "to": 2100, "count": 100}}});
    let statuses = std::thread::scope(|scope| {
        let send = || agent.post(&url).send_json(&grid).unwrap().status().as_u16();
        [(); 2].map(|()| scope.spawn(send)).map(|sent| sent.join().unwrap())
    });
    // On a loaded machine the second may have waited too long for the first.
    assert!(
        statuses.contains(&200) && statuses.iter().all(|status| [200, 503].contains(status)),
        "{statuses:?}"
    );
    let peak = peak_memory(&process);
    assert!(peak < MOST_MEMORY, "{peak} MiB");
}

#[test]
fn hostile_paths_and_parameters_are_refused_with_reasons() {
    let data = tempfile::tempdir().unwrap();
    let (_up, server) = listen(data.path(), &[&["up", "--workers", "1"][..], &UNLIMITED].concat());
    let sweep = submit(&server, 0.2, &json!({}));
    wait(&server, &sweep, completed);
    let document = get(&format!("{server}/openapi.json"));
    // Every GET route with its own parameters, and one that does not exist.
    let mut routes = Vec::new();
    for (path, operations) in document["paths"].as_object().unwrap() {
        let names = operations["get"]["parameters"].as_array().cloned().unwrap_or_default();
        let queries: Vec<String> = names
            .iter()
            .filter(|parameter| parameter["in"] == "query")
            .map(|parameter| parameter["name"].as_str().unwrap().to_owned())
            .chain(["no_such_parameter".to_owned()])
            .collect();
        if operations["get"].is_object() && !path.ends_with("/events") {
            routes.push((path.clone(), queries));
        }
    }
    assert!(routes.len() > 15, "{routes:?}");
    let agent = agent();
    let case = (
        select(routes),
        prop::option::weighted(0.3, text()),
        prop::option::weighted(0.3, text()),
        prop::collection::vec((any::<Index>(), text()), 0..4),
    );
    let outcome = runner(600).run(&case, |((path, names), id, number, queries)| {
        let path = path
            .replace("{id}", &id.map_or(sweep.clone(), |id| percent_encoded(&id)))
            .replace("{n}", &number.map_or("1".to_owned(), |number| percent_encoded(&number)))
            .replace("{name}", "paper-200m");
        let queries: Vec<String> = queries
            .iter()
            // A long poll is held back by design.
            .filter(|(name, _)| name.get(&names) != "wait")
            .map(|(name, value)| format!("{}={}", name.get(&names), percent_encoded(value)))
            .collect();
        let answer = agent.get(format!("{server}{path}?{}", queries.join("&"))).call();
        check(answer.map_err(|error| TestCaseError::fail(format!("{path}: {error}")))?)?;
        Ok(())
    });
    outcome.unwrap();
}

/// Sends bytes as they are and returns what comes back until the server closes or has been silent for so long.
fn raw(server: &str, bytes: &[u8], silence: Duration) -> String {
    let mut stream = TcpStream::connect(server.trim_start_matches("http://")).unwrap();
    stream.set_read_timeout(Some(silence)).unwrap();
    // The server may have closed before everything was sent.
    let _ = stream.write_all(bytes);
    let mut answer = Vec::new();
    let _ = stream.take(1 << 20).read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
fn bytes_that_are_not_http_do_no_harm() {
    let data = tempfile::tempdir().unwrap();
    let (_server, server) = server(data.path());
    let garbage = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..400),
        (select(vec!["GET", "POST", "PRI", "\0"]), text(), prop::collection::vec((text(), text()), 0..3))
            .prop_map(|(method, path, headers)| {
                let headers: String =
                    headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
                format!("{method} /{path} HTTP/1.1\r\n{headers}connection: close\r\n\r\n").into_bytes()
            }),
    ];
    let outcome = runner(100).run(&garbage, |bytes| {
        let answer = raw(&server, &bytes, Duration::from_millis(50));
        prop_assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 "), "{}", answer);
        prop_assert!(!answer.starts_with("HTTP/1.1 5"), "{}", answer);
        Ok(())
    });
    outcome.unwrap();
    // RFC 9112 section 3.2.
    for (target, hosts, status) in [
        ("/livez", "Host: localhost\r\n", "200"),
        ("http://localhost/livez", "Host: localhost\r\n", "200"),
        ("/livez", "", "400"),
        ("/livez", "Host: localhost\r\nHost: localhost\r\n", "400"),
        ("http://evil.example/livez", "Host: localhost\r\n", "400"),
    ] {
        let request = format!("GET {target} HTTP/1.1\r\n{hosts}Connection: close\r\n\r\n");
        let answer = raw(&server, request.as_bytes(), PATIENCE);
        assert!(answer.starts_with(&format!("HTTP/1.1 {status}")), "{request}{answer}");
    }
    // Nothing of a body that is too large is asked for.
    let request = "POST /v1/sweeps HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n\
                   Content-Length: 99999999999\r\nExpect: 100-continue\r\nConnection: close\r\n\r\n";
    let answer = raw(&server, request.as_bytes(), PATIENCE);
    assert!(answer.starts_with("HTTP/1.1 413"), "{answer}");
    assert_eq!(get(&format!("{server}/livez"))["status"], "ok");
}

#[test]
fn no_path_leads_out_of_the_routes() {
    let data = tempfile::tempdir().unwrap();
    std::fs::write(data.path().join("outside"), "not to be served").unwrap();
    let (_server, server) = server(data.path());
    for path in [
        "/../outside",
        "/..%2foutside",
        "/v1/../../outside",
        "/v1/sweeps/..%2f..%2foutside",
        "/v1/sweeps/%2e%2e/outside",
        "/v1/scenarios/..%2f..%2f..%2foutside",
        "/v1/scenarios/%2fetc%2fpasswd",
        "//outside",
        "/v1/sweeps/x/points/1/..%2f..%2f..%2fblobs",
    ] {
        let answer = raw(
            &server,
            format!("GET {path} HTTP/1.1\r\nhost: x\r\nconnection: close\r\n\r\n").as_bytes(),
            PATIENCE,
        );
        assert!(answer.starts_with("HTTP/1.1 40"), "{path}: {answer}");
        assert!(
            answer.contains("application/problem+json") && !answer.contains("not to be served"),
            "{path}: {answer}"
        );
    }
}

#[test]
fn bodies_that_unfold_or_never_end_are_refused() {
    let data = tempfile::tempdir().unwrap();
    let (process, server) = server(data.path());
    let url = format!("{server}/v1/sweeps");
    let post = |body: &[u8], encoding: Option<&str>| {
        // Each over a connection of its own: one whose body was refused is of no more use.
        let mut request = agent().post(&url).content_type("application/json");
        if let Some(encoding) = encoding {
            request = request.header("content-encoding", encoding);
        }
        // A body that is refused early breaks off the sending.
        request.send(body).map_or(413, |response| check(response).unwrap())
    };
    // 10 kB of gzip that would be 10 MB.
    let bomb = gzip_of_zeros(10 << 20);
    assert!(bomb.len() < 20 << 10, "{}", bomb.len());
    assert_eq!(post(&bomb, Some("gzip")), 415);
    assert_eq!(post("[".repeat(1 << 20).as_bytes(), None), 400);
    assert_eq!(post(r#"{"axes":"#.repeat(100_000).as_bytes(), None), 400);
    let limit = get(&format!("{server}/v1/limits"))["body_bytes"].as_u64().unwrap();
    assert_eq!(post(&vec![b' '; limit as usize + 1], None), 413);
    // Four billion points of a hundred bytes' request.
    let axis = json!({"from": 0.01, "to": 0.02, "count": u32::MAX});
    let huge = json!({"preset": "paper-200m", "axes": {"flow_rate": axis, "mud_density": axis}});
    assert_eq!(post(huge.to_string().as_bytes(), None), 422);
    // A length that is announced but never sent holds nobody up.
    let mut promise = TcpStream::connect(server.trim_start_matches("http://")).unwrap();
    let head = "POST /v1/sweeps HTTP/1.1\r\nhost: x\r\ncontent-type: application/json\r\ncontent-length: 1000000\r\n\r\n{";
    promise.write_all(head.as_bytes()).unwrap();
    assert_eq!(get(&format!("{server}/livez"))["status"], "ok");
    assert!(peak_memory(&process) < 512, "{} MiB", peak_memory(&process));
}

/// Zeros as gzip makes them.
fn gzip_of_zeros(size: usize) -> Vec<u8> {
    use std::process::{Command, Stdio};
    let mut gzip =
        Command::new("gzip").arg("-9").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = gzip.stdin.take().unwrap();
    let writer = std::thread::spawn(move || input.write_all(&vec![0; size]).unwrap());
    let mut zipped = Vec::new();
    gzip.stdout.take().unwrap().read_to_end(&mut zipped).unwrap();
    writer.join().unwrap();
    gzip.wait().unwrap();
    zipped
}
