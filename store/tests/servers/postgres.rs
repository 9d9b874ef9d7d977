//! A PostgreSQL server of a test's own.

use std::ffi::OsStr;
use std::fs::File;
use std::io::Write as _;
use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::certificate::Certified;
use super::small_disk::SmallDisk;

/// Names the directory of PostgreSQL's programs where they are in none of the usual places.
const PROGRAMS: &str = "DRILLSWEEP_POSTGRES_BIN";

/// Time that a server may take to start or to stop.
const PATIENCE: Duration = Duration::from_secs(60);

/// The settings of all servers: small, and without a copy of what goes to the disk. A server that is killed loses nothing: the system
/// keeps what a process has written.
const SETTINGS: &[&str] = &[
    "listen_addresses=127.0.0.1",
    "fsync=off",
    "full_page_writes=off",
    "shared_buffers=32MB",
    "max_wal_size=256MB",
    "max_connections=60",
    "log_min_messages=warning",
];

/// A running server with an empty database; it ends with the value, and with the test's process.
pub(crate) struct Server {
    directory: TempDir,
    data: PathBuf,
    process: Option<Child>,
    port: u16,
    /// Beside those of all servers.
    settings: &'static [&'static str],
}

impl Server {
    /// Makes a server and starts it.
    pub(crate) fn start() -> Self {
        Self::start_with(&[])
    }

    /// The same with other settings, which have precedence.
    pub(crate) fn start_with(settings: &'static [&'static str]) -> Self {
        let mut server = Self::make(settings);
        server.resume();
        server
    }

    /// Makes a server to which nobody connects but by TLS, and starts it.
    #[allow(dead_code, reason = "not all that use this module have certificates")]
    pub(crate) fn start_with_tls(certified: &Certified) -> Self {
        let mut server = Self::make(&["ssl=on"]);
        server.write("server.crt", &certified.certificate);
        server.write("server.key", &certified.key);
        server.write("pg_hba.conf", "hostssl all all 127.0.0.1/32 trust\n");
        server.resume();
        server
    }

    /// A disk for a server.
    #[allow(dead_code, reason = "not all that use this module fill disks")]
    pub(crate) fn disk(megabytes: u32) -> SmallDisk {
        SmallDisk::of(&as_server(Path::new("env")), megabytes)
    }

    /// Makes a server with its tables on a disk and its write-ahead log on another one, and starts it.
    #[allow(dead_code, reason = "not all that use this module fill disks")]
    pub(crate) fn start_on(tables: &SmallDisk, log: &SmallDisk) -> Self {
        let directory = TempDir::new().expect("a temporary directory");
        let settings = &["max_wal_size=8MB", "min_wal_size=2MB"];
        let mut server =
            Self::make_in(directory, tables.path().join("data"), Some(&log.path().join("log")), settings);
        server.resume();
        server
    }

    fn make(settings: &'static [&'static str]) -> Self {
        let directory = TempDir::new().expect("a temporary directory");
        let data = directory.path().join("data");
        Self::make_in(directory, data, None, settings)
    }

    /// Makes a server whose files are in a directory, but for its log where another one is given for that.
    fn make_in(
        directory: TempDir,
        data: PathBuf,
        log: Option<&Path>,
        settings: &'static [&'static str],
    ) -> Self {
        // The server's user is not the one that the directory belongs to.
        super::run(Command::new("chmod").arg("0777").arg(directory.path()));
        let server = Self { directory, data, process: None, port: super::free_ports::<1>()[0], settings };
        match log {
            Some(log) => initialise(&server.data, &[OsStr::new("--waldir"), log.as_os_str()]),
            None => copy_files(&initialised(), &server.data),
        }
        server
    }

    /// Writes a file of its own that nobody else can read, as it wants its keys.
    fn write(&self, name: &str, content: &str) {
        let draft = self.directory.path().join("draft");
        std::fs::write(&draft, content).expect("a file");
        super::run(as_server(Path::new("install")).arg("--mode=600").arg(&draft).arg(self.data().join(name)));
        std::fs::remove_file(draft).expect("the file");
    }

    /// The directory of its files.
    pub(crate) fn data(&self) -> PathBuf {
        self.data.clone()
    }

    /// Content of its own log.
    #[allow(dead_code, reason = "not all that use this module read it")]
    pub(crate) fn log(&self) -> String {
        std::fs::read_to_string(self.directory.path().join("log")).unwrap_or_default()
    }

    /// Its address.
    #[allow(dead_code, reason = "not all that use this module stand before it")]
    pub(crate) fn address(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    /// The number of its process, whose children serve the connections.
    #[allow(dead_code, reason = "not all that use this module measure it")]
    pub(crate) fn process(&self) -> u32 {
        self.process.as_ref().expect("it runs").id()
    }

    /// The URL of its database.
    pub(crate) fn url(&self) -> String {
        format!("postgres://drillsweep@127.0.0.1:{}/postgres", self.port)
    }

    /// Copies the running server's files, as a standby has them that is behind.
    #[allow(dead_code, reason = "not all that use this module fail over")]
    pub(crate) fn copy(&self) -> PathBuf {
        let copy = self.directory.path().join("copy");
        super::run(
            program("pg_basebackup")
                .args([
                    "--host=127.0.0.1",
                    "--username=drillsweep",
                    "--checkpoint=fast",
                    "--no-sync",
                    "--port",
                ])
                .arg(self.port.to_string())
                .arg("--pgdata")
                .arg(&copy),
        );
        copy
    }

    /// Kills the server; a copy of it takes its place, at the same address. What was confirmed since the copy was made is lost.
    #[allow(dead_code, reason = "not all that use this module fail over")]
    pub(crate) fn fail_over(&mut self, copy: &Path) {
        self.kill();
        std::fs::remove_dir_all(self.data()).expect("the files of the old one");
        std::fs::rename(copy, self.data()).expect("the copy");
        self.resume();
    }

    /// Output of a statement, as `psql` prints it without its frame.
    #[allow(dead_code, reason = "not all that use this module ask it something")]
    pub(crate) fn query(&self, statement: &str) -> String {
        self.try_query(statement).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The same of a statement that may fail; then what `psql` says of it.
    #[allow(dead_code, reason = "not all that use this module ask it something")]
    pub(crate) fn try_query(&self, statement: &str) -> Result<String, String> {
        let mut client = program("psql");
        client.args(["--no-align", "--tuples-only", "--no-psqlrc", "--dbname"]).arg(self.url());
        let output = client.args(["--command", statement]).output().expect("psql");
        let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
        if output.status.success() { Ok(said(&output.stdout)) } else { Err(said(&output.stderr)) }
    }

    /// Runs a script of `psql` with variables.
    #[allow(dead_code, reason = "not all that use this module have scripts")]
    pub(crate) fn run_script(&self, script: &str, variables: &[(&str, &str)]) {
        let mut client = program("psql");
        client.args(["--quiet", "--no-psqlrc", "--dbname"]).arg(self.url());
        for (name, value) in variables {
            client.arg(format!("--set={name}={value}"));
        }
        let mut process = client.stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("psql");
        process.stdin.take().expect("a pipe").write_all(script.as_bytes()).expect("psql reads");
        let output = process.wait_with_output().expect("psql ends");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }

    /// Starts it again after it was ended, on the same files and the same port.
    pub(crate) fn resume(&mut self) {
        let deadline = Instant::now() + PATIENCE;
        while !self.is_ready() {
            assert!(Instant::now() < deadline, "PostgreSQL did not start:\n{}", self.log());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Ends it at once, as a crash does: what it had not written is lost.
    #[allow(dead_code, reason = "not all that use this module crash a server")]
    pub(crate) fn kill(&mut self) {
        self.end("KILL");
    }

    fn spawn(&mut self) {
        let mut command = program("postgres");
        command.arg("-D").arg(self.data()).arg("-k").arg(self.directory.path());
        command.arg("-p").arg(self.port.to_string());
        for setting in SETTINGS.iter().chain(self.settings) {
            command.args(["-c", setting]);
        }
        let log = std::fs::File::options()
            .create(true)
            .append(true)
            .open(self.directory.path().join("log"))
            .expect("a log file");
        self.process = Some(
            command.stdout(log.try_clone().expect("another handle")).stderr(log).spawn().expect("setpriv"),
        );
    }

    fn end(&mut self, signal: &str) {
        if let Some(mut process) = self.process.take() {
            super::run(Command::new("kill").arg(format!("-{signal}")).arg(process.id().to_string()));
            process.wait().expect("it ends");
        }
    }

    fn is_ready(&mut self) -> bool {
        // A server that was killed leaves processes behind for a moment, beside which another one does not start.
        if self.process.as_mut().is_none_or(|process| process.try_wait().expect("its state").is_some()) {
            self.spawn();
        }
        program("pg_isready")
            .args(["--host=127.0.0.1", "--quiet", "--port"])
            .arg(self.port.to_string())
            .status()
            .is_ok_and(|status| status.success())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.end("QUIT");
    }
}

/// The files of a new database, for all tests with this target directory to copy: `initdb` takes longer than most tests do.
fn initialised() -> PathBuf {
    let version = program("initdb").arg("--version").output().expect("the version of PostgreSQL").stdout;
    let version = String::from_utf8_lossy(&version).replace(|sign: char| !sign.is_ascii_alphanumeric(), "-");
    let files = Path::new(env!("CARGO_TARGET_TMPDIR")).join(version);
    // Until the end of this function others wait, of other processes too.
    let lock = File::create(files.with_extension("lock")).expect("a lock file in the target directory");
    lock.lock().expect("a lock on it");
    if !files.exists() {
        // The server's user need not reach the target directory.
        let directory = TempDir::new().expect("a temporary directory");
        super::run(Command::new("chmod").arg("0777").arg(directory.path()));
        let data = directory.path().join("data");
        initialise(&data, &[]);
        // Under another name first: what has its name is whole.
        let part = files.with_extension("part");
        let _ = std::fs::remove_dir_all(&part);
        copy_files(&data, &part);
        std::fs::rename(&part, &files).expect("the files' name");
    }
    files
}

/// Copies files with their owner.
fn copy_files(files: &Path, to: &Path) {
    super::run(Command::new("cp").args(["--recursive", "--preserve=mode,ownership"]).arg(files).arg(to));
}

/// Makes the files of a new database.
fn initialise(data: &Path, more: &[&OsStr]) {
    let options = [
        "--auth=trust",
        "--username=drillsweep",
        "--encoding=UTF8",
        "--no-locale",
        "--no-sync",
        "--wal-segsize=1",
    ];
    super::run(program("initdb").args(options).args(more).arg("--pgdata").arg(data));
}

/// One of PostgreSQL's programs.
fn program(name: &str) -> Command {
    as_server(&programs().join(name))
}

/// A program as the server's user. PostgreSQL's refuse to run as root: then they run as the user of the package. What they start ends with
/// the test's thread, however that ends.
fn as_server(program: &Path) -> Command {
    let mut command = Command::new("setpriv");
    command.args(["--pdeathsig", "QUIT"]);
    // Safe to ask in a test: whose process this is does not change.
    if std::fs::metadata("/proc/self").is_ok_and(|own| own.uid() == 0) {
        command.args(["--reuid=postgres", "--regid=postgres", "--clear-groups"]);
    }
    // In the home of another user are certificates that it must not read.
    command.arg(program).current_dir("/").env("HOME", "/");
    command
}

/// The directory of PostgreSQL's programs: of the latest version where there are several.
pub(crate) fn programs() -> PathBuf {
    if let Some(directory) = std::env::var_os(PROGRAMS) {
        return PathBuf::from(directory);
    }
    let installed = std::fs::read_dir("/usr/lib/postgresql").into_iter().flatten().filter_map(Result::ok);
    let version = |path: &PathBuf| path.file_name()?.to_str()?.parse::<u32>().ok();
    let latest = installed.map(|entry| entry.path()).max_by_key(version).map(|path| path.join("bin"));
    let on_path =
        || std::env::split_paths(&std::env::var_os("PATH")?).find(|path| path.join("initdb").exists());
    latest.filter(|path| path.join("initdb").exists()).or_else(on_path).unwrap_or_else(|| {
        panic!("the tests need a PostgreSQL server: install one (Debian: postgresql), or name the directory of its programs in {PROGRAMS}")
    })
}
