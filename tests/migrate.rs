//! A store that moves between a machine's own disk and servers, and one that comes back from a backup: by the commands that people type.

use std::collections::BTreeMap;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::Signal;
use serde_json::{Value, json};

use crate::faults::{Logged, bytes, checked, command, request, serve, submit};
use crate::remote::Site;
use crate::servers::proxy::{Behaviour, Proxy};
use crate::{BINARY, PATIENCE, Process, completed, get, wait};

/// Points of the sweep that is moved.
const POINTS: u64 = 6;

/// A data directory with a sweep that is finished and one that is not; its server was killed, and has left its write-ahead log behind.
struct Laptop {
    data: tempfile::TempDir,
    finished: String,
    queued: String,
}

impl Laptop {
    fn new() -> Self {
        let data = tempfile::tempdir().unwrap();
        let mut up =
            Logged::start(&mut command(data.path(), &["up", "--workers", "2", "--listen", "127.0.0.1:0"]));
        let server = up.address();
        let finished = submit(&server, &swept());
        assert_eq!(wait(&server, &finished, completed)["counts"]["succeeded"], POINTS);
        // The workers take themselves off the list.
        up.process.signal(Signal::TERM);
        assert!(up.process.0.wait().unwrap().success());
        let (mut server, address) = serve(data.path(), None);
        let queued = submit(&address, &request(1.0, 1, 2));
        server.kill();
        assert!(data.path().join("drillsweep.sqlite-wal").exists(), "it was killed");
        Laptop { data, finished, queued }
    }

    fn path(&self) -> &Path {
        self.data.path()
    }

    /// Database, log and objects, by name.
    fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let mut files = BTreeMap::new();
        collect_files(&self.path().join("blobs"), &mut files);
        for name in ["drillsweep.sqlite", "drillsweep.sqlite-wal"] {
            files.insert(name.to_owned(), std::fs::read(self.path().join(name)).unwrap());
        }
        files
    }
}

fn collect_files(directory: &Path, files: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect_files(&path, files);
        } else {
            files.insert(path.display().to_string(), std::fs::read(&path).unwrap());
        }
    }
}

/// Request of the sweep that is computed before the move.
fn swept() -> Value {
    let mut request = request(0.5, 3, 2);
    request["set"]["accuracy"] = "draft".into();
    request
}

/// Moves a data directory to a site, to a database and an object store that are reached at some address.
fn to_site(site: &Site, data: &Path, database: &str, objects: Option<&str>) -> Command {
    let mut command = command(data, &["migrate", "--json", "--to", database]);
    let of_site = site.command(&[]);
    for (name, value) in of_site.get_envs().filter_map(|(name, value)| Some((name.to_str()?, value?))) {
        match name {
            "DRILLSWEEP_OBJECTS" => command.arg("--to-objects").arg(value),
            "DRILLSWEEP_DATABASE" => &mut command,
            _ => command.env(name, value),
        };
    }
    if let Some(address) = objects {
        command.env("AWS_ENDPOINT_URL", format!("http://{address}"));
    }
    command
}

/// Runs a command that reports in JSON and must succeed.
fn report(command: &mut Command) -> Value {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Answers of a server about a finished sweep: all of them, to the byte.
fn events(server: &str, sweep: &str) -> Vec<Vec<u8>> {
    let url = format!("{server}/v1/sweeps/{sweep}");
    let mut told: Vec<Vec<u8>> = ["?", "/points?limit=500", "/table?format=csv", "/events"]
        .map(|part| bytes(&format!("{url}{part}")))
        .into();
    for point in 1..=POINTS {
        for table in ["profile", "statics", "lines", "contacts", "loads", "energy", "history"] {
            told.push(bytes(&format!("{url}/points/{point}/{table}?format=parquet")));
        }
    }
    told
}

#[test]
fn a_laptops_store_moves_to_a_server_and_a_bucket_and_back() {
    let (laptop, site) = (Laptop::new(), Site::new());
    let files = laptop.files();
    let moved = report(&mut to_site(&site, laptop.path(), &site.postgres.url(), None));
    assert_eq!(moved["rows"]["sweep"], 2, "{moved}");
    assert_eq!(moved["rows"]["result"], POINTS);
    assert!(moved["blobs"].as_u64().unwrap() >= 5 * POINTS && moved["blobs_present"] == 0, "{moved}");
    assert!(laptop.files() == files, "what it was read from is untouched");
    let whole = (POINTS, Vec::<Value>::new());
    assert_eq!(checked(&mut site.command(&["check", "--json"])), whole);

    let again = to_site(&site, laptop.path(), &site.postgres.url(), None).output().unwrap();
    let reason = String::from_utf8_lossy(&again.stderr).into_owned();
    assert!(!again.status.success() && reason.contains("it must be empty"), "{reason}");

    let (mut local, local_server) = serve(laptop.path(), None);
    let (mut remote, remote_server) = site.serve();
    assert!(events(&remote_server, &laptop.finished) == events(&local_server, &laptop.finished));
    let list = |server: &str| get(&format!("{server}/v1/sweeps"));
    assert_eq!(list(&remote_server), list(&local_server));
    local.kill();
    // Nobody is there to compute anything.
    let known = submit(&remote_server, &swept());
    let known = get(&format!("{remote_server}/v1/sweeps/{known}"));
    assert_eq!((&known["counts"]["succeeded"], &known["state"]), (&json!(POINTS), &json!("completed")));
    // Queued points continue there.
    let mut worker = site.worker();
    assert_eq!(wait(&remote_server, &laptop.queued, completed)["counts"]["succeeded"], 2);
    let busy = site.command(&["migrate"]).arg("--to-data").arg(laptop.path().join("busy")).output().unwrap();
    let reason = String::from_utf8_lossy(&busy.stderr).into_owned();
    assert!(!busy.status.success() && reason.contains("1 workers sent a heartbeat"), "{reason}");
    worker.process.signal(Signal::TERM);
    worker.process.0.wait().unwrap();

    let home = laptop.path().join("home");
    let moved = report(site.command(&["migrate", "--json"]).arg("--to-data").arg(&home));
    assert_eq!(moved["rows"]["sweep"], 3);
    assert_eq!(checked(&mut command(&home, &["check", "--json"])), (POINTS + 2, vec![]));
    let (_home, home_server) = serve(&home, None);
    for sweep in [&laptop.finished, &laptop.queued] {
        let table = |server: &str| bytes(&format!("{server}/v1/sweeps/{sweep}/table?format=csv"));
        assert!(table(&home_server) == table(&remote_server));
    }
    assert!(events(&home_server, &laptop.finished) == events(&remote_server, &laptop.finished));
    assert_eq!(list(&home_server), list(&remote_server));
    remote.kill();
}

#[test]
fn a_killed_migration_leaves_no_partial_store_and_resumes() {
    let (laptop, site) = (Laptop::new(), Site::new());
    let files = laptop.files();
    let database = site.postgres.url();
    let count = |table: &str| site.postgres.query(&format!("SELECT count(*) FROM {table}"));

    // Among the blobs: at some moment nothing gets through any more.
    const ENOUGH: u64 = 400_000;
    let proxy = Proxy::before(&site.objects.address());
    proxy.set(Behaviour::StallAfter(ENOUGH));
    let mut stalled = to_site(&site, laptop.path(), &database, Some(proxy.address()));
    let stalled = Process(stalled.stdout(Stdio::null()).spawn().unwrap());
    proxy.wait_for(ENOUGH);
    stalled.kill();
    assert_eq!(count("sweep"), "0");

    // Among the rows: one table cannot be written for a while.
    std::thread::scope(|scope| {
        let lock = "BEGIN; LOCK TABLE event IN SHARE MODE; SELECT pg_sleep(600);";
        scope.spawn(|| site.postgres.run_script(lock, &[]));
        let is_true = |what: &str| {
            let deadline = Instant::now() + PATIENCE;
            while site.postgres.query(&format!("SELECT {what}")) != "t" {
                assert!(Instant::now() < deadline, "not so: {what}");
                std::thread::sleep(Duration::from_millis(20));
            }
        };
        is_true("EXISTS (SELECT 1 FROM pg_locks WHERE relation = 'event'::regclass AND mode = 'ShareLock')");
        let mut held_up = to_site(&site, laptop.path(), &database, None);
        let held_up = Process(held_up.stdout(Stdio::null()).spawn().unwrap());
        is_true("EXISTS (SELECT 1 FROM pg_locks WHERE relation = 'event'::regclass AND NOT granted)");
        held_up.kill();
        assert_eq!(count("sweep"), "0", "what is not whole is not seen");
        site.postgres.query(
            "SELECT pg_cancel_backend(pid) FROM pg_stat_activity WHERE query LIKE '%pg_sleep(600)%' AND pid <> pg_backend_pid()",
        );
        is_true("NOT EXISTS (SELECT 1 FROM pg_stat_activity WHERE application_name = 'drillsweep')");
    });
    for table in ["scenario", "work", "sweep", "point", "event"] {
        assert_eq!(count(table), "0", "{table}");
    }

    let moved = report(&mut to_site(&site, laptop.path(), &database, None));
    assert_eq!(moved["blobs_present"], moved["blobs"], "none was copied again: {moved}");
    assert_eq!(moved["rows"]["result"], POINTS);
    assert_eq!(checked(&mut site.command(&["check", "--json"])), (POINTS, vec![]));
    assert!(laptop.files() == files);
}

#[test]
fn a_destination_is_required_in_full() {
    let (nothing, laptop) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (mut server, _) = serve(laptop.path(), None);
    server.kill();
    let refused = |data: &Path, arguments: &[&str]| {
        let output = command(data, &["migrate"]).args(arguments).output().unwrap();
        assert!(!output.status.success());
        String::from_utf8(output.stderr).unwrap()
    };
    let said = refused(nothing.path(), &["--to-data", "elsewhere"]);
    assert!(said.contains("there is no store in"), "{said}");
    for arguments in [&[][..], &["--to-database", "there.sqlite"], &["--to-objects", "blobs"]] {
        let said = refused(laptop.path(), arguments);
        assert!(said.contains("no destination"), "{said}");
    }
    let itself = laptop.path().to_str().unwrap();
    let said = refused(laptop.path(), &["--to-data", itself]);
    assert!(said.contains("cannot be copied to itself"), "{said}");
}

/// The commands that the documents give for backups, in their order.
fn recipes() -> Vec<String> {
    let text = include_str!("../docs/operations.md");
    let section = text.split_once("## Backup and restore").unwrap().1;
    let section = section.split("\n## ").next().unwrap();
    section.split("```sh\n").skip(1).map(|block| block.split("```").next().unwrap().to_owned()).collect()
}

/// Runs commands of the documents, each of which must succeed.
fn run_recipe(recipe: &str, directory: &Path, environment: &Command) {
    let programs = Path::new(BINARY).parent().unwrap();
    let path = std::env::join_paths(
        std::iter::once(programs.to_owned())
            .chain(std::env::split_paths(&std::env::var_os("PATH").unwrap()))
            .chain([crate::servers::postgres::programs()]),
    );
    let mut shell = Command::new("sh");
    // As most shells start.
    shell.args(["-euxc", &format!("umask 022\n{recipe}")]).current_dir(directory).env("PATH", path.unwrap());
    shell.envs(environment.get_envs().filter_map(|(name, value)| Some((name, value?))));
    let output = shell.output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{}{said}", String::from_utf8_lossy(&output.stdout));
}

/// Files and directories below a directory to which group or others have access.
fn public(directory: &Path) -> Vec<PathBuf> {
    let paths = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let found = paths.flat_map(|path| {
        let file = path.symlink_metadata().unwrap();
        let mut found = if file.is_dir() { public(&path) } else { Vec::new() };
        if file.permissions().mode() & 0o077 != 0 {
            found.push(path);
        }
        found
    });
    found.collect()
}

#[test]
fn store_that_others_may_read_is_reported() {
    let place = tempfile::tempdir().unwrap();
    let data = place.path().join("data");
    let (mut server, _) = serve(&data, None);
    assert!(!server.log().contains("other users have access"));
    server.kill();
    let database = data.join("drillsweep.sqlite");
    for (path, mode) in [(&database, 0o644), (&data, 0o750)] {
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).unwrap();
        let warning = format!("other users have access to {} (mode {mode:04o})", path.display());
        let (mut server, _) = serve(&data, None);
        server.wait_for(|log| {
            log.lines().any(|line| line.contains("WARN") && line.contains(&warning)).then_some(())
        });
        server.kill();
        let warnings = report(&mut command(&data, &["check", "--json"]))["warnings"].clone();
        let is_there = |text: &Value| text.as_str().unwrap().starts_with(&warning);
        assert!(warnings.as_array().unwrap().iter().any(is_there), "{warnings}");
    }
}

#[test]
fn the_backups_of_the_documents_bring_a_whole_store_back() {
    let [local_backup, local_restore, remote_backup, objects_backup, remote_restore] =
        recipes().try_into().expect("a backup and a restore of either engine");
    let (laptop, site, work) = (Laptop::new(), Site::new(), tempfile::tempdir().unwrap());
    report(&mut to_site(&site, laptop.path(), &site.postgres.url(), None));
    let nothing_is_public = || assert_eq!(public(work.path()), Vec::<PathBuf>::new());

    // The service runs while its backup is made.
    std::os::unix::fs::symlink(laptop.path(), work.path().join("data")).unwrap();
    let (mut server, address) = serve(laptop.path(), None);
    let before = events(&address, &laptop.finished);
    let nothing = Command::new("true");
    run_recipe(&local_backup, work.path(), &nothing);
    server.kill();
    std::fs::remove_file(work.path().join("data")).unwrap();
    nothing_is_public();
    run_recipe(&local_restore, work.path(), &nothing);
    let (mut server, address) = serve(&work.path().join("data"), None);
    assert!(events(&address, &laptop.finished) == before, "of the directory");
    // With the write-ahead log of a server that runs.
    nothing_is_public();
    assert!(!server.log().contains("other users have access"));
    server.kill();

    let (mut server, address) = site.serve();
    assert!(events(&address, &laptop.finished) == before);
    run_recipe(&remote_backup, work.path(), &site.command(&[]));
    // Another place of the same service.
    let elsewhere = |command: &mut Command, variable: &str| {
        let objects = site.objects.location("", "elsewhere").to_string();
        command.env(variable, objects);
    };
    let mut environment = site.command(&[]);
    elsewhere(&mut environment, "BACKUP_OBJECTS");
    // The second time nothing is copied but the rows.
    for _ in 0..2 {
        run_recipe(&objects_backup, work.path(), &environment);
    }
    nothing_is_public();
    server.kill();
    site.objects.files("team").iter().for_each(|file| site.objects.delete(&file.name));
    site.postgres.query("CREATE DATABASE restored");
    let url = site.postgres.url();
    let restored = url.strip_suffix("postgres").unwrap().to_owned() + "restored";
    let mut environment = site.command(&[]);
    environment.env("DRILLSWEEP_DATABASE", &restored);
    elsewhere(&mut environment, "DRILLSWEEP_OBJECTS");
    run_recipe(&remote_restore, work.path(), &environment);
    let mut server = site.command(&["serve", "--listen", "127.0.0.1:0"]);
    elsewhere(&mut server, "DRILLSWEEP_OBJECTS");
    let server = Logged::start(server.env("DRILLSWEEP_DATABASE", &restored));
    assert!(events(&server.address(), &laptop.finished) == before, "of the server");
}
