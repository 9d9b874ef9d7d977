//! Upkeep that the service does by itself, time after time.

use std::time::Duration;

use drillsweep_server::{Config, Listeners, RetentionConfig, serve};
use tokio::net::TcpListener;
use tokio::sync::oneshot;
use tokio::time::timeout;

use crate::bench::Bench;

/// Far more than a collection takes.
const SOON: Duration = Duration::from_secs(20);

#[tokio::test]
async fn a_service_that_retains_collects_and_says_when() {
    let bench = Bench::new().await;
    let listeners = Listeners { api: TcpListener::bind("127.0.0.1:0").await.unwrap(), metrics: None };
    let (stop, stopped) = oneshot::channel::<()>();
    let interval = Some(Duration::from_millis(5));
    let config =
        Config { retention: RetentionConfig { interval, ..RetentionConfig::default() }, ..Config::default() };
    let service = tokio::spawn(serve(listeners, bench.store.clone(), config, async {
        let _ = stopped.await;
    }));
    let collected = async {
        loop {
            let last = bench.get("/v1/retention").await.json()["last"].clone();
            if last["deleted"].is_object() {
                return last;
            }
            tokio::task::yield_now().await;
        }
    };
    let last = timeout(SOON, collected).await.expect("a collection ends");
    assert_eq!(last["deleted"]["sweeps"], 0);
    stop.send(()).unwrap();
    timeout(SOON, service).await.expect("the service ends").unwrap().unwrap();
}
