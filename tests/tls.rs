//! TLS between machines: servers and workers that reach database and object store by it alone, under a private authority.

use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use drillsweep_store::ObjectsLocation;

use crate::faults::{Logged, checked, request, submit};
use crate::servers::certificate::{Authority, Certified};
use crate::servers::postgres::Server as Postgres;
use crate::servers::seaweed::Seaweed;
use crate::{BINARY, completed, wait};
use rustls::pki_types::pem::PemObject as _;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{ServerConfig, ServerConnection, StreamOwned};

/// A database and an object store, and the file of the authority that has certified both.
struct Site {
    postgres: Postgres,
    objects: Seaweed,
    directory: tempfile::TempDir,
}

impl Site {
    fn new() -> Self {
        let authority = Authority::new();
        let certified = authority.certify(&["127.0.0.1"]);
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("authority.pem"), authority.certificate()).unwrap();
        std::fs::write(directory.path().join("another.pem"), Authority::new().certificate()).unwrap();
        Site {
            postgres: Postgres::start_with_tls(&certified),
            objects: Seaweed::start_with_tls(&certified),
            directory,
        }
    }

    fn authority(&self) -> PathBuf {
        self.directory.path().join("authority.pem")
    }

    /// A command that reaches both by TLS, and trusts the authorities of a file.
    fn command(&self, arguments: &[&str], trusted: &Path) -> Command {
        let location = self.objects.location(&self.objects.address(), "team");
        let ObjectsLocation::S3 { settings, .. } = &location else { panic!("a bucket") };
        let mut command = Command::new(BINARY);
        command.args(arguments).arg("--data").arg(self.directory.path().join("data"));
        command
            .env("DRILLSWEEP_DATABASE", format!("{}?sslmode=verify-full", self.postgres.url()))
            .env("DRILLSWEEP_OBJECTS", location.to_string())
            .env("AWS_ENDPOINT_URL", self.objects.https())
            .env("AWS_REGION", &settings["region"])
            .env("AWS_ACCESS_KEY_ID", &settings["access_key_id"])
            .env("AWS_SECRET_ACCESS_KEY", &settings["secret_access_key"])
            .env("SSL_CERT_FILE", trusted);
        command
    }
}

#[test]
fn servers_and_workers_reach_database_and_bucket_under_a_private_authority() {
    let site = Site::new();
    let server = Logged::start(&mut site.command(&["serve", "--listen", "127.0.0.1:0"], &site.authority()));
    let address = server.address();
    let _worker = Logged::start(&mut site.command(&["worker", "--lease-seconds", "2"], &site.authority()));
    let sweep = submit(&address, &request(0.5, 2, 1));
    assert_eq!(wait(&address, &sweep, completed)["counts"]["succeeded"], 2);
    assert_eq!(ureq::get(format!("{address}/readyz")).call().unwrap().status(), 200);
    let plain = site.postgres.query(
        "SELECT count(*) FROM pg_stat_ssl JOIN pg_stat_activity USING (pid) WHERE application_name = 'drillsweep' AND NOT ssl",
    );
    assert_eq!(plain, "0");
    assert_eq!(checked(&mut site.command(&["check", "--json"], &site.authority())), (2, vec![]));

    // An authority that neither has a certificate of: both are refused at once.
    let another = site.directory.path().join("another.pem");
    let output = site.command(&["check"], &another).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{said}");
    assert!(said.contains("the certificate of the database's server is not accepted"), "{said}");
    let database =
        format!("{}?sslmode=verify-full&sslrootcert={}", site.postgres.url(), site.authority().display());
    for arguments in [&["check"][..], &["worker"], &["serve", "--listen", "127.0.0.1:0"]] {
        let mut command = site.command(arguments, &another);
        command.env("DRILLSWEEP_DATABASE", &database).env("DRILLSWEEP_LOG", "info");
        let output = command.output().unwrap();
        let said = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        assert!(!output.status.success(), "{arguments:?}: {said}");
        for words in [
            "the certificate of the object store is not accepted",
            "invalid peer certificate",
            "SSL_CERT_FILE",
        ] {
            assert!(said.contains(words), "{arguments:?}: {said}");
        }
        assert!(!said.contains("backing off"), "{arguments:?} tried again: {said}");
    }
}

#[test]
fn commands_reach_a_server_behind_tls_under_a_private_authority() {
    let authority = Authority::new();
    let address = ready_behind_tls(&authority.certify(&["127.0.0.1"]));
    let directory = tempfile::tempdir().unwrap();
    let health = |trusted: &Authority| {
        let file = directory.path().join("trusted.pem");
        std::fs::write(&file, trusted.certificate()).unwrap();
        let mut command = Command::new(BINARY);
        let output =
            command.args(["health", "--server", &format!("https://{address}")]).env("SSL_CERT_FILE", file);
        let output = output.output().unwrap();
        (output.status.success(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(health(&authority), (true, String::new()));
    let (is_trusted, said) = health(&Authority::new());
    assert!(!is_trusted && said.contains("invalid peer certificate"), "{said}");
}

/// The address of what a reverse proxy is to a command: it answers all requests over TLS as a server that is ready.
fn ready_behind_tls(certified: &Certified) -> SocketAddr {
    const BODY: &str = r#"{"status":"ok"}"#;
    let _ = rustls::crypto::ring::default_provider().install_default();
    let certificate = CertificateDer::from_pem_slice(certified.certificate.as_bytes()).unwrap();
    let key = PrivateKeyDer::from_pem_slice(certified.key.as_bytes()).unwrap();
    let config = ServerConfig::builder().with_no_client_auth().with_single_cert(vec![certificate], key);
    let config = Arc::new(config.unwrap());
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream =
                StreamOwned::new(ServerConnection::new(config.clone()).unwrap(), stream.unwrap());
            // A client without trust sends no request.
            let Ok(true) = read_head(&mut stream) else { continue };
            let head = format!(
                "HTTP/1.1 200 OK\r\ncontent-type: application/json\r\ncontent-length: {}\r\n",
                BODY.len()
            );
            write!(stream, "{head}connection: close\r\n\r\n{BODY}").unwrap();
            stream.conn.send_close_notify();
            stream.flush().unwrap();
        }
    });
    address
}

/// Reads a request's head; false where the connection ends before.
fn read_head(stream: &mut impl std::io::Read) -> std::io::Result<bool> {
    for line in BufReader::new(stream).lines() {
        if line?.is_empty() {
            return Ok(true);
        }
    }
    Ok(false)
}
