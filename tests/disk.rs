//! PostgreSQL's disks full: that of its tables, by which single statements fail, and that of its write-ahead log, by which it ends.

use std::process::Command;
use std::time::Instant;

use serde_json::Value;

use crate::faults::{Logged, bytes, checked, request, submit};
use crate::remote::wait_through_faults;
use crate::servers::postgres::Server as Postgres;
use crate::{BINARY, PATIENCE, completed, get, wait};

#[test]
fn a_full_disk_of_postgresql_is_reported_and_loses_nothing() {
    let (tables, log) = (Postgres::disk(96), Postgres::disk(40));
    let mut postgres = Postgres::start_on(&tables, &log);
    let (data, url) = (tempfile::tempdir().unwrap(), postgres.url());
    let command = |arguments: &[&str]| {
        let mut command = Command::new(BINARY);
        command.args(arguments).arg("--data").arg(data.path()).env("DRILLSWEEP_DATABASE", &url);
        command
    };
    let server = Logged::start(&mut command(&["serve", "--listen", "127.0.0.1:0"]));
    let address = server.address();
    let worker = Logged::start(&mut command(&["worker", "--lease-seconds", "2"]));
    let first = submit(&address, &request(0.5, 2, 1));
    wait(&address, &first, completed);
    let table = |sweep: &str| bytes(&format!("{address}/v1/sweeps/{sweep}/table?format=csv"));
    let before = table(&first);

    // No room for new pages: a submission is refused and leaves nothing behind, a result waits, and what is there can be read.
    let second = submit(&address, &request(0.6, 8, 8));
    worker.wait_for(|log| (log.matches("point claimed").count() >= 4).then_some(()));
    tables.fill_but(0);
    worker.wait_for(|log| log.contains("No space left on device").then_some(()));
    let refused = ureq::post(format!("{address}/v1/sweeps")).config().http_status_as_error(false).build();
    let mut refused = refused.send_json(request(0.7, 10, 10)).unwrap();
    let problem: Value = refused.body_mut().read_json().unwrap();
    assert_eq!(problem["status"], 507, "{problem}");
    assert_eq!(problem["type"], "urn:drillsweep:problem:storage-full", "{problem}");
    assert_eq!(get(&format!("{address}/v1/sweeps"))["sweeps"].as_array().unwrap().len(), 2);
    assert!(table(&first) == before);
    tables.make_room();
    assert_eq!(wait(&address, &second, completed)["counts"]["succeeded"], 64);

    // No room for the log: the database ends, whatever it was doing, until there is room and somebody starts it again.
    let third = submit(&address, &request(0.8, 8, 4));
    worker.wait_for(|log| (log.matches("point claimed").count() >= 2 + 64 + 4).then_some(()));
    log.fill_but(0);
    let deadline = Instant::now() + PATIENCE;
    while postgres
        .try_query("CREATE TABLE other AS SELECT generate_series(1, 200000); DROP TABLE other")
        .is_ok()
    {
        assert!(Instant::now() < deadline, "its log goes on");
    }
    log.make_room();
    postgres.resume();
    assert_eq!(wait_through_faults(&address, &third)["counts"]["succeeded"], 32);
    assert!(postgres.log().contains("PANIC"), "it did not end by that:\n{}", postgres.log());
    assert!(table(&first) == before);
    assert_eq!(checked(&mut command(&["check", "--json"])), (2 + 64 + 32, vec![]));
}
