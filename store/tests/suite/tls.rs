//! TLS to PostgreSQL: whose certificates are accepted, and that nothing goes past it.

use drillsweep_store::{Role, Store, StoreConfig, StoreError};
use tempfile::NamedTempFile;

use crate::bench::{claim, finish, submit, sweep, sweep_record};
use crate::servers::certificate::{Authority, Certified};
use crate::servers::postgres::Server;

/// Opens the store of a server, with these parameters of its URL and an authority that is to be trusted.
async fn open(server: &Server, parameters: &str, trusted: Option<&Authority>) -> Result<Store, StoreError> {
    // Each connection reads the file: it lasts as long as the server.
    let directory = server.data().parent().unwrap().to_owned();
    let mut url = format!("{}?{parameters}", server.url());
    if let Some(authority) = trusted {
        let file = NamedTempFile::new_in(&directory).unwrap().into_temp_path().keep().unwrap();
        std::fs::write(&file, authority.certificate()).unwrap();
        url += &format!("&sslrootcert={}", file.display());
    }
    let mut config = StoreConfig::in_directory(&directory.join("store"), Role::Server);
    config.database = url.parse().unwrap();
    Store::open(&config).await
}

fn start(certified: &Certified) -> Server {
    Server::start_with_tls(certified)
}

/// Asserts that a certificate is refused, at once and in words that name the reason.
#[track_caller]
fn assert_refused(opened: Result<Store, StoreError>, reason: &str) {
    let error = opened.expect_err("it must not be trusted");
    assert!(matches!(error, StoreError::Untrusted(_)) && !error.is_busy(), "{error:?}");
    let text = error.to_string();
    assert!(text.contains("certificate of the database's server is not accepted"), "{text}");
    assert!(text.contains(reason), "{text}");
}

#[tokio::test]
async fn a_certificate_of_a_trusted_authority_is_accepted_and_all_goes_by_it() {
    let authority = Authority::new();
    let server = start(&authority.certify(&["127.0.0.1", "localhost"]));
    let connections =
        "FROM pg_stat_ssl JOIN pg_stat_activity USING (pid) WHERE application_name = 'drillsweep'";
    for (parameters, trusted) in [
        ("sslmode=verify-full", Some(&authority)),
        ("sslmode=verify-ca", Some(&authority)),
        ("sslmode=require", None),
        // As libpq does, where nothing is said of it.
        ("application_name=drillsweep", None),
    ] {
        let store = open(&server, parameters, trusted).await.unwrap();
        submit(&store, &sweep(parameters, [1])).await;
        let all = server.query(&format!("SELECT count(*) > 0 AND bool_and(ssl) {connections}"));
        assert_eq!(all, "t", "{parameters}");
        store.close().await;
    }
    let store = open(&server, "sslmode=verify-full", Some(&authority)).await.unwrap();
    assert!(finish(&store, &claim(&store, "w").await).await);
    assert_eq!(sweep_record(&store, "sslmode=verify-full").await.counts.done, 1);
}

#[tokio::test]
async fn any_other_certificate_is_refused_with_the_reason() {
    let (authority, another) = (Authority::new(), Authority::new());
    let server = start(&authority.certify(&["localhost"]));
    // Nobody else vouches for it either, nor does the system.
    assert_refused(open(&server, "sslmode=verify-full", Some(&another)).await, "invalid peer certificate");
    assert_refused(open(&server, "sslmode=verify-ca", Some(&another)).await, "invalid peer certificate");
    // It is reached as 127.0.0.1.
    assert_refused(open(&server, "sslmode=verify-full", Some(&authority)).await, "not valid for name");
    assert!(open(&server, "sslmode=verify-ca", Some(&authority)).await.is_ok());

    let old = start(&authority.certify_long_ago(&["127.0.0.1"]));
    assert_refused(open(&old, "sslmode=verify-full", Some(&authority)).await, "expired");
}

#[tokio::test]
async fn required_tls_refuses_plain_clients_and_plain_servers() {
    let authority = Authority::new();
    let server = start(&authority.certify(&["127.0.0.1"]));
    let error = open(&server, "sslmode=disable", None).await.unwrap_err();
    assert!(!error.is_busy() && error.to_string().contains("no encryption"), "{error}");

    let plain = Server::start();
    let error = open(&plain, "sslmode=verify-full", Some(&authority)).await.unwrap_err();
    assert!(!error.is_busy() && error.to_string().contains("server does not support TLS"), "{error}");
}
