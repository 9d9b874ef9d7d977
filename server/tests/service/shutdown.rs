//! The service on a real socket, until it is told to stop.

use std::time::Duration;

use drillsweep_server::{Config, Listeners, serve};
use serde_json::json;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio::time::timeout;

use crate::bench::Bench;

/// Far less than the wait of the long poll, far more than an answer takes.
const SOON: Duration = Duration::from_secs(20);

#[tokio::test]
async fn shutting_down_answers_open_long_polls_at_once() {
    let bench = Bench::new().await;
    let id = bench.submit(json!({"preset": "paper-200m"})).await;
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let listeners = Listeners { api: listener, metrics: None };
    let (stop, stopped) = oneshot::channel::<()>();
    let shutdown = async {
        // Dropping the sender stops the service too.
        let _ = stopped.await;
    };
    let service = tokio::spawn(serve(listeners, bench.store.clone(), Config::default(), shutdown));

    // One request answered on the connection shows that the service runs; the next one is then under way.
    let mut connection = TcpStream::connect(address).await.unwrap();
    connection.write_all(b"GET /livez HTTP/1.1\r\nHost: localhost\r\n\r\n").await.unwrap();
    let mut buffer = [0; 4096];
    let length = timeout(SOON, connection.read(&mut buffer)).await.unwrap().unwrap();
    assert!(buffer[..length].starts_with(b"HTTP/1.1 200"));
    let request = format!("GET /v1/sweeps/{id}?wait=60s HTTP/1.1\r\nHost: localhost\r\n\r\n");
    connection.write_all(request.as_bytes()).await.unwrap();
    let mut answer = String::new();
    let read = async {
        stop.send(()).unwrap();
        connection.read_to_string(&mut answer).await
    };
    timeout(SOON, read).await.expect("the connection ends").unwrap();
    assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 200"), "{answer}");
    timeout(SOON, service).await.expect("the service ends").unwrap().unwrap();
    assert!(TcpStream::connect(address).await.is_err());
}
