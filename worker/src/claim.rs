//! The worker's loop: claim, simulate, store, again.

use std::sync::Arc;
use std::time::Duration;

use drillsweep_sim::PHYSICS_VERSION;
use drillsweep_sim::control::Control;
use drillsweep_sim::scenario::Scenario;
use drillsweep_store::{
    Claim, FailureClass, Lease, NewArtifact, Role, Store, StoreConfig, StoreError, WorkerRecord,
};
use serde_json::{Value, json};
use tokio::sync::watch;

use crate::calibration::calibrate;
use crate::compute::{ComputeError, Computed, EncodedArtifact, compute, simulated_time_total};
use crate::lease::{Heartbeat, StopReason, Verdict, Watched};

/// How a worker works.
#[derive(Debug, Clone)]
pub struct WorkerConfig {
    /// Where the store lies.
    pub store: StoreConfig,
    /// How long a point stays with a silent worker.
    pub lease: Duration,
    /// How long an idle worker waits before it looks for work again.
    pub poll_interval: Duration,
    /// Ends when there is nothing left to claim.
    pub drain: bool,
}

impl WorkerConfig {
    /// The usual worker on a store.
    pub fn new(mut store: StoreConfig) -> Self {
        store.role = Role::Worker;
        Self {
            store,
            lease: Duration::from_secs(60),
            poll_interval: Duration::from_millis(500),
            drain: false,
        }
    }
}

/// Why a worker ended early.
#[derive(Debug, thiserror::Error)]
pub enum WorkerError {
    /// The store cannot be opened.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The heartbeat thread cannot be started.
    #[error("the heartbeat thread cannot be started: {0}")]
    Heartbeat(#[from] std::io::Error),
}

/// Measures the machine, unless that was done; plans do without where it fails.
async fn keep_speed(store: &Store, host: &str) {
    let measure = async {
        if store.machine_speed(i64::from(PHYSICS_VERSION)).await?.is_some() {
            return Ok(());
        }
        let speed = tokio::task::spawn_blocking(calibrate).await;
        match speed {
            Ok(Ok(speed)) => {
                store.keep_machine_speed(host, i64::from(PHYSICS_VERSION), &json!(speed).to_string()).await
            }
            failed => {
                tracing::warn!(?failed, "the machine's speed is not known");
                Ok(())
            }
        }
    };
    if let Err(error) = measure.await {
        tracing::warn!(%error, "the machine's speed is not kept");
    }
}

/// How one point ended.
enum Ended {
    Computed(Result<Box<Computed>, ComputeError>),
    Panicked(String),
}

/// Claims and simulates points until `stop` turns true, or until nothing is left where the worker drains.
///
/// A point under way when the worker is told to stop goes back to the queue, its attempt refunded.
///
/// # Errors
/// When the store cannot be opened or the heartbeat cannot be started. Later failures of the store are logged and
/// tried again.
pub async fn run(config: WorkerConfig, mut stop: watch::Receiver<bool>) -> Result<(), WorkerError> {
    let id = format!("worker-{}", uuid::Uuid::now_v7().simple());
    let store = Store::open(&config.store).await?;
    let record = WorkerRecord {
        id: id.clone(),
        host: rustix::system::uname().nodename().to_string_lossy().into_owned(),
        process: i64::from(std::process::id()),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        physics_version: i64::from(PHYSICS_VERSION),
        started: 0,
        last_seen: 0,
    };
    keep_speed(&store, &record.host).await;
    let heartbeat = Heartbeat::start(config.store.clone(), record, config.lease)?;
    tracing::info!(worker = %id, "worker ready");
    while !*stop.borrow() {
        let lease_ms = config.lease.as_millis() as i64;
        match store.claim(&id, i64::from(PHYSICS_VERSION), lease_ms).await {
            Ok(Some(claim)) => work_on(&store, &heartbeat, claim, &mut stop).await,
            Ok(None) if config.drain => break,
            Ok(None) => idle(config.poll_interval, &mut stop).await,
            Err(error) => {
                tracing::warn!(%error, "no work can be claimed");
                idle(config.poll_interval * 4, &mut stop).await;
            }
        }
    }
    drop(heartbeat);
    store.close().await;
    tracing::info!(worker = %id, "worker done");
    Ok(())
}

async fn idle(time: Duration, stop: &mut watch::Receiver<bool>) {
    // A closed channel means that nobody can ask for a stop any more; the pause holds all the same.
    let stopped = async {
        if stop.wait_for(|stop| *stop).await.is_err() {
            std::future::pending::<()>().await;
        }
    };
    tokio::select! {
        () = tokio::time::sleep(time) => {}
        () = stopped => {}
    }
}

async fn work_on(store: &Store, heartbeat: &Heartbeat, claim: Claim, stop: &mut watch::Receiver<bool>) {
    let lease = claim.lease;
    let point = hex(&lease.key);
    tracing::info!(point = %&point[..12], attempt = lease.attempt, "point claimed");
    let scenario = match Scenario::from_json(&claim.scenario_json) {
        Ok(scenario) => scenario,
        Err(problem) => {
            let error = ComputeError::Invalid(problem.to_string());
            let ended = Ended::Computed(Err(error));
            end(store, &lease, ended, StopReason::None, false).await;
            return;
        }
    };
    let control = Arc::new(Control::new());
    let verdict = Arc::new(Verdict::default());
    heartbeat.watch(Some(Watched {
        lease: lease.clone(),
        control: control.clone(),
        duration: simulated_time_total(&scenario),
        verdict: verdict.clone(),
    }));
    let watched = control.clone();
    let mut computing = tokio::task::spawn_blocking(move || compute(&scenario, &watched));
    let mut stopped = false;
    let joined = loop {
        tokio::select! {
            joined = &mut computing => break joined,
            Ok(_) = stop.wait_for(|stop| *stop), if !stopped => {
                stopped = true;
                control.cancel();
            }
        }
    };
    let ended = match joined {
        Ok(result) => Ended::Computed(result.map(Box::new)),
        Err(error) => Ended::Panicked(panic_text(error)),
    };
    end(store, &lease, ended, verdict.get(), stopped).await;
    heartbeat.watch(None);
}

/// Writes how a point ended. The store being out of reach is tried again until the lease must be gone.
async fn end(store: &Store, lease: &Lease, ended: Ended, reason: StopReason, stopped: bool) {
    const TRIES: u32 = 5;
    for attempt in 0..TRIES {
        match write_end(store, lease, &ended, reason, stopped).await {
            Ok(true) => return,
            Ok(false) => {
                tracing::warn!(point = %&hex(&lease.key)[..12], attempt = lease.attempt, "lease lost, result dropped");
                return;
            }
            Err(error) => {
                tracing::warn!(%error, "the end of a point cannot be stored");
                tokio::time::sleep(Duration::from_millis(250) * 2_u32.pow(attempt)).await;
            }
        }
    }
    // The lease runs out by itself, and the point is taken over.
}

async fn write_end(
    store: &Store,
    lease: &Lease,
    ended: &Ended,
    reason: StopReason,
    stopped: bool,
) -> drillsweep_store::Result<bool> {
    match ended {
        Ended::Computed(Ok(computed)) => match upload(store, computed).await {
            Ok(artifacts) => {
                let summary = Value::Object(computed.summary_row()).to_string();
                let provenance = Value::Object(computed.provenance.clone()).to_string();
                store.finish_done(lease, &summary, &provenance, &artifacts).await
            }
            Err(error) => {
                tracing::warn!(%error, "artifacts cannot be written");
                let json = json!({ "class": "infrastructure", "reason": error.to_string() });
                store.retry_later(lease, &json.to_string()).await
            }
        },
        Ended::Computed(Err(ComputeError::Cancelled)) => match reason {
            StopReason::Cancelled => {
                store
                    .finish_failed(
                        lease,
                        FailureClass::Cancelled,
                        r#"{"class":"cancelled","reason":"cancelled"}"#,
                    )
                    .await
            }
            StopReason::LeaseLost => Ok(false),
            StopReason::None => {
                debug_assert!(stopped, "only a stop cancels without a reason");
                store.release(lease).await
            }
        },
        Ended::Computed(Err(error)) => {
            tracing::warn!(point = %&hex(&lease.key)[..12], %error, "point failed");
            store.finish_failed(lease, FailureClass::Physical, &error.to_json().to_string()).await
        }
        Ended::Panicked(text) => {
            tracing::error!(point = %&hex(&lease.key)[..12], text, "the simulation panicked");
            let json = json!({ "class": "crash", "reason": format!("the simulation panicked: {text}") });
            store.finish_failed(lease, FailureClass::Physical, &json.to_string()).await
        }
    }
}

/// Writes the tables as blobs, before any row names them.
async fn upload(store: &Store, computed: &Computed) -> drillsweep_store::Result<Vec<NewArtifact>> {
    let mut artifacts = Vec::new();
    for EncodedArtifact { name, media_type, row_count, bytes } in computed.encode()? {
        let size = bytes.len() as i64;
        artifacts.push(NewArtifact {
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            blob: store.blobs().put(bytes).await?,
            bytes: size,
            row_count: row_count as i64,
        });
    }
    Ok(artifacts)
}

fn panic_text(error: tokio::task::JoinError) -> String {
    match error.try_into_panic() {
        Ok(panic) => panic
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| panic.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "without a message".to_owned()),
        Err(error) => error.to_string(),
    }
}

fn hex(key: &[u8; 32]) -> String {
    key.iter().map(|byte| format!("{byte:02x}")).collect()
}
