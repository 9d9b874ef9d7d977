//! The worker's loop: claim, simulate, store, again.

use std::any::Any;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use drillsweep_scenario::{FailureClass, PointError, Scenario, compose};
use drillsweep_sim::PHYSICS_VERSION;
use drillsweep_sim::control::Control;
use drillsweep_store::{
    BlobId, Claim, Finished, Lease, NamedFile, NewArtifact, NewResult, Renewal, Role, Store, StoreConfig,
    StoreError, WorkerRecord, with_backoff,
};
use drillsweep_study::footprint::Footprint;
use jiff::Timestamp;
use prometheus_client::registry::Registry;
use serde_json::{Value, json};
use tokio::sync::watch;
use tracing::Instrument as _;

use crate::calibration::calibrate;
use crate::compute::{Computation, compute_from, simulated_time_total};
use crate::encode::EncodedArtifact;
use crate::error::ComputeError;
use crate::lease::{Heartbeat, StopReason, Verdict, Watched};
use crate::memory::Memory;
use crate::metrics::{Metrics, Outcome};
use crate::priority::{NotComputed, compute_at_low_priority, parallel_threads};
use crate::provenance::WorkerProvenance;
use crate::spool::{Suspended, SuspendedError};

/// Settings of a worker.
#[derive(Debug, Clone)]
pub struct WorkerConfig {
    /// Location of the store.
    pub store: StoreConfig,
    /// Directory for temporary files, which hold the records of a running point.
    pub scratch: PathBuf,
    /// Duration of a lease, after which a silent worker loses its point.
    pub lease: Duration,
    /// Interval at which an idle worker looks for work.
    pub poll_interval: Duration,
    /// Ends when there is nothing left to claim.
    pub drain: bool,
    /// Ends after so long, the running point suspended for another worker.
    pub max_runtime: Option<Duration>,
    /// Longest that one attempt at a point may take; one that takes longer fails, and a retry goes on from there.
    pub point_timeout: Option<Duration>,
    /// Simulated seconds per second at most: a point that is held back can be watched, stopped and taken over as it runs, however fast the
    /// machine is.
    pub pace: Option<f64>,
    /// Version of the physics whose points it claims: that of this program, except in tests of workers of several versions.
    pub physics_version: u32,
    /// Registry of counts for operators, in which this worker enters its own and those of its use of the store.
    pub registry: Option<Arc<Mutex<Registry>>>,
}

impl WorkerConfig {
    /// The usual worker on a store, with its temporary files in the system's directory for them.
    pub fn new(mut store: StoreConfig) -> Self {
        store.role = Role::Worker;
        Self {
            store,
            scratch: std::env::temp_dir(),
            lease: Duration::from_secs(60),
            poll_interval: Duration::from_millis(500),
            drain: false,
            max_runtime: None,
            point_timeout: None,
            pace: None,
            physics_version: PHYSICS_VERSION,
            registry: None,
        }
    }
}

/// Errors that end a worker.
#[derive(Debug, thiserror::Error)]
pub enum WorkerError {
    /// The store cannot be opened.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The heartbeat thread cannot be started.
    #[error("the heartbeat thread cannot be started: {0}")]
    Heartbeat(#[from] std::io::Error),
}

/// Measures the machine, unless that was done; if it fails plans have no times.
async fn keep_speed(store: &Store, host: &str) {
    let measure = async {
        if store.machine_speed(i64::from(PHYSICS_VERSION)).await?.is_some() {
            return Ok(());
        }
        let speed = compute_at_low_priority(calibrate).await;
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
        tracing::warn!(%error, "the machine's speed cannot be stored");
    }
}

/// End of one point.
enum Ended {
    Computed(Result<Computation, ComputeError>),
    Panicked(String),
}

/// Reason to stop a point, other than the heartbeat.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Halt {
    /// None.
    No,
    /// The worker ends.
    Stop,
    /// The point has taken too long.
    Timeout(Duration),
}

/// Claims and simulates points until `stop` turns true, its time is over, or, if the worker drains, nothing is left.
///
/// A point that is running when the worker is asked to stop is queued again with a checkpoint, and its attempt is not counted.
///
/// # Errors
/// The store cannot be opened or the heartbeat cannot be started. Later failures of the store are logged and
/// tried again.
pub async fn run(config: WorkerConfig, stop: watch::Receiver<bool>) -> Result<(), WorkerError> {
    let mut stop = match config.max_runtime {
        Some(time) => stop_after(time, stop),
        None => stop,
    };
    let id = format!("worker-{}", uuid::Uuid::now_v7().simple());
    let store = with_backoff(|| Store::open(&config.store)).await?;
    store.check_certificate().await?;
    let record = WorkerRecord {
        id: id.clone(),
        host: host_name(),
        process: i64::from(std::process::id()),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        physics_version: i64::from(config.physics_version),
        started: 0,
        last_seen: 0,
    };
    // Before the first claim, so that the holder of a point can always be found.
    with_backoff(|| store.register_worker(&record)).await?;
    keep_speed(&store, &record.host).await;
    let metrics = Metrics::default();
    if let Some(registry) = &config.registry {
        let mut registry = registry.lock().unwrap_or_else(PoisonError::into_inner);
        let registry = registry.sub_registry_with_prefix("drillsweep");
        store.register_metrics(registry);
        metrics.register(registry.sub_registry_with_prefix("worker"));
    }
    let heartbeat = Heartbeat::start(config.store.clone(), record.clone(), config.lease, metrics.clone())?;
    let mut changes = store.work_changes().await;
    tracing::info!(worker = %id, "worker ready");
    let worker =
        Worker { config: &config, store: &store, heartbeat: &heartbeat, record: &record, metrics: &metrics };
    while !*stop.borrow() {
        let asked = Instant::now();
        match store.claim(&id, record.physics_version, worker.lease_ms()).await {
            Ok(Some(claim)) => {
                let mut claim_ms = Some(asked.elapsed().as_micros() as f64 / 1e3);
                let mut next = Some(claim);
                while let Some(claim) = next {
                    let key = hex(&claim.lease.key);
                    let token = claim.lease.fencing_token;
                    let span = tracing::info_span!("point", key = &key[..12], fencing_token = token);
                    span.in_scope(|| tracing::info!(claim_ms, "point claimed"));
                    next = worker.work_on(claim, &mut stop).instrument(span).await;
                    // It came with the answer to the result before it.
                    claim_ms = None;
                }
            }
            Ok(None) if config.drain => break,
            Ok(None) => tokio::select! {
                () = changes.wait(config.poll_interval) => {}
                () = stopped(&mut stop) => {}
            },
            Err(error) => {
                metrics.store_failures.inc();
                tracing::warn!(%error, "no work can be claimed");
                idle(config.poll_interval * 4, &mut stop).await;
            }
        }
    }
    // After the last heartbeat, which would enter it again.
    drop(heartbeat);
    if let Err(error) = store.remove_worker(&id).await {
        tracing::warn!(%error, "the worker's entry stays until it is stale");
    }
    store.close().await;
    tracing::info!(worker = %id, "worker done");
    Ok(())
}

/// The name of this host, as workers register it.
pub fn host_name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

/// Turns true after some time, or with `stop` before that.
fn stop_after(time: Duration, mut stop: watch::Receiver<bool>) -> watch::Receiver<bool> {
    let (sender, receiver) = watch::channel(false);
    tokio::spawn(async move {
        idle(time, &mut stop).await;
        sender.send_replace(true);
        sender.closed().await;
    });
    receiver
}

async fn idle(time: Duration, stop: &mut watch::Receiver<bool>) {
    tokio::select! {
        () = tokio::time::sleep(time) => {}
        () = stopped(stop) => {}
    }
}

/// Returns once a stop is requested. A closed channel means that no request can come any more.
async fn stopped(stop: &mut watch::Receiver<bool>) {
    if stop.wait_for(|stop| *stop).await.is_err() {
        std::future::pending::<()>().await;
    }
}

/// Resources of the loop.
struct Worker<'a> {
    config: &'a WorkerConfig,
    store: &'a Store,
    heartbeat: &'a Heartbeat,
    record: &'a WorkerRecord,
    metrics: &'a Metrics,
}

impl Worker<'_> {
    /// Duration of a lease \[ms\].
    fn lease_ms(&self) -> i64 {
        self.config.lease.as_millis() as i64
    }

    /// Computes a point and stores its outcome. Returns the next point if it was claimed with the result.
    async fn work_on(&self, claim: Claim, stop: &mut watch::Receiver<bool>) -> Option<Claim> {
        let Self { config, store, heartbeat, record, metrics } = self;
        let lease = claim.lease;
        metrics.claimed(lease.fencing_token);
        let begun = Instant::now();
        let scenario = match compose(&claim.scenario.base_json, &claim.scenario.changes_json) {
            Ok(scenario) => scenario,
            Err(problem) => {
                let error = ComputeError::Invalid(problem.to_string());
                let ended = Ended::Computed(Err(error));
                return self.end(&lease, ended, (StopReason::None, Halt::No), begun, stop).await;
            }
        };
        if let Some(error) = too_large(&scenario) {
            let ended = Ended::Computed(Err(error));
            return self.end(&lease, ended, (StopReason::None, Halt::No), begun, stop).await;
        }
        let control = Arc::new(config.pace.map_or_else(Control::new, paced));
        let verdict = Arc::new(Verdict::default());
        heartbeat.watch(Some(Watched {
            lease: lease.clone(),
            control: control.clone(),
            duration: simulated_time_total(&scenario),
            verdict: verdict.clone(),
        }));
        let watched = control.clone();
        let started = Timestamp::now();
        let scratch = config.scratch.clone();
        let suspended = read_suspended(store, claim.checkpoint, &scratch).await;
        let span = tracing::info_span!("compute");
        let mut computing = std::pin::pin!(compute_at_low_priority(move || {
            span.in_scope(|| compute_from(&scenario, &watched, suspended, &scratch))
        }));
        let timeout = config.point_timeout.map(|time| (time, tokio::time::Instant::now() + time));
        let overdue = async {
            match timeout {
                Some((time, at)) => {
                    tokio::time::sleep_until(at).await;
                    time
                }
                None => std::future::pending().await,
            }
        };
        tokio::pin!(overdue);
        let mut halt = Halt::No;
        let joined = loop {
            tokio::select! {
                joined = &mut computing => break joined,
                Ok(_) = stop.wait_for(|stop| *stop), if halt == Halt::No => {
                    halt = Halt::Stop;
                    control.suspend();
                }
                time = &mut overdue, if halt == Halt::No => {
                    halt = Halt::Timeout(time);
                    control.suspend();
                }
            }
        };
        let ended = match joined {
            Ok(Ok(Computation::Finished(mut computed))) => {
                computed.provenance.worker = Some(WorkerProvenance {
                    host: record.host.clone(),
                    worker: record.id.clone(),
                    fencing_token: lease.fencing_token,
                    started,
                    ended: Timestamp::now(),
                });
                Ended::Computed(Ok(Computation::Finished(computed)))
            }
            Ok(result) => Ended::Computed(result),
            Err(NotComputed::NotStarted(error)) => Ended::Computed(Err(ComputeError::Thread(error))),
            Err(NotComputed::Panicked(panic)) => Ended::Panicked(panic_text(&*panic)),
        };
        let halted = (verdict.get(), halt);
        let next =
            self.end(&lease, ended, halted, begun, stop).instrument(tracing::info_span!("store")).await;
        heartbeat.watch(None);
        next
    }

    /// Writes how a point ended. The store being out of reach is tried again for as long as the lease was renewed at the latest: after
    /// that the point is somebody else's. Returns the next point if it was claimed with the result.
    async fn end(
        &self,
        lease: &Lease,
        mut ended: Ended,
        halted: (StopReason, Halt),
        begun: Instant,
        stop: &watch::Receiver<bool>,
    ) -> Option<Claim> {
        /// The longest wait between two tries.
        const LONGEST: Duration = Duration::from_secs(4);
        let deadline = Instant::now() + self.config.lease;
        let mut pause = Duration::from_millis(250);
        loop {
            let goes_on = !*stop.borrow();
            match self.write_end(lease, &mut ended, halted, goes_on).await {
                Ok((outcome, Finished { is_stored, next })) => {
                    let outcome = if is_stored { outcome } else { Outcome::Lost };
                    self.metrics.ended(outcome, begun.elapsed());
                    if !is_stored {
                        tracing::warn!("lease lost, result dropped");
                    }
                    return next;
                }
                Err(error) => {
                    self.metrics.store_failures.inc();
                    tracing::warn!(%error, "the end of a point cannot be stored");
                }
            }
            if Instant::now() + pause > deadline {
                // The lease runs out by itself, and the point is taken over.
                self.metrics.ended(Outcome::Lost, begun.elapsed());
                return None;
            }
            tokio::time::sleep(pause).await;
            pause = LONGEST.min(2 * pause);
        }
    }

    /// Writes it once; a result together with the claim of the next point, if the worker goes on.
    async fn write_end(
        &self,
        lease: &Lease,
        ended: &mut Ended,
        (reason, halt): (StopReason, Halt),
        goes_on: bool,
    ) -> drillsweep_store::Result<(Outcome, Finished)> {
        let Self { store, record, .. } = self;
        let (outcome, is_stored) = match ended {
            Ended::Computed(Ok(Computation::Finished(computed))) => {
                match self.upload(lease, &computed.artifacts).await {
                    Ok(None) => (Outcome::Lost, false),
                    Ok(Some(artifacts)) => {
                        let summary = Value::Object(computed.summary_row()).to_string();
                        let provenance = json!(computed.provenance).to_string();
                        let result = NewResult {
                            summary_json: &summary,
                            provenance_json: &provenance,
                            artifacts: &artifacts,
                            // A cost study measures times.
                            is_repeatable: computed.study.is_none(),
                        };
                        if goes_on {
                            let version = record.physics_version;
                            let finished =
                                store.finish_and_claim(lease, &result, version, self.lease_ms()).await?;
                            return Ok((Outcome::Succeeded, finished));
                        }
                        (Outcome::Succeeded, store.finish_done(lease, &result).await?)
                    }
                    // The database, by which blobs are reserved, or a certificate, which is not waited for: the whole is tried again.
                    Err(error @ (StoreError::Database(_) | StoreError::UntrustedObjects(_))) => {
                        return Err(error);
                    }
                    Err(error) => {
                        tracing::warn!(%error, "artifacts cannot be written");
                        let error = PointError::new(FailureClass::Infrastructure, error.to_string());
                        (Outcome::Retried, store.retry_later(lease, &text_of(&error)).await?)
                    }
                }
            }
            Ended::Computed(Ok(Computation::Suspended(suspended))) => {
                halted(store, lease, Some(suspended), reason, halt).await?
            }
            Ended::Computed(Err(error)) if error.is_of_this_worker() => {
                tracing::error!(%error, "this worker cannot compute the point");
                (Outcome::Retried, store.retry_later(lease, &text_of(&error.to_point_error())).await?)
            }
            Ended::Computed(Err(ComputeError::Cancelled)) => halted(store, lease, None, reason, halt).await?,
            Ended::Computed(Err(error)) => {
                tracing::warn!(%error, "point failed");
                (Outcome::Failed, store.finish_failed(lease, &text_of(&error.to_point_error())).await?)
            }
            Ended::Panicked(text) => {
                tracing::error!(text, "the simulation panicked");
                let reason = format!("the simulation panicked: {text}");
                let error = PointError::new(FailureClass::Crash, reason);
                (Outcome::Crashed, store.crashed(lease, &text_of(&error)).await?)
            }
        };
        Ok((outcome, Finished { is_stored, next: None }))
    }

    /// Writes the tables as blobs, before any row refers to them; none if the lease is lost.
    async fn upload(
        &self,
        lease: &Lease,
        artifacts: &[EncodedArtifact],
    ) -> Result<Option<Vec<NewArtifact>>, StoreError> {
        let mut files = Vec::new();
        for artifact in artifacts {
            files.push(NamedFile::read(&artifact.file).await?);
        }
        let blobs: Vec<BlobId> = files.iter().map(NamedFile::id).collect();
        if self.store.reserve(lease, self.lease_ms(), &blobs).await? == Renewal::Lost {
            return Ok(None);
        }
        let mut stored = Vec::new();
        for (EncodedArtifact { name, media_type, row_count, .. }, file) in artifacts.iter().zip(&files) {
            self.store.blobs().put_named(file).await?;
            stored.push(NewArtifact {
                name: (*name).to_owned(),
                media_type: (*media_type).to_owned(),
                blob: file.id(),
                bytes: file.bytes() as i64,
                row_count: *row_count as i64,
            });
        }
        Ok(Some(stored))
    }
}

/// A control whose runs simulate this many seconds per second at most.
fn paced(pace: f64) -> Control {
    /// Interval at which a run that is held back looks for a request to stop.
    const LOOK: Duration = Duration::from_millis(10);
    let started = Instant::now();
    Control::observed_by(move |control, time| {
        let due = started + Duration::from_secs_f64(time / pace);
        while !control.is_cancelled() && !control.is_suspended() && Instant::now() < due {
            std::thread::sleep(LOOK.min(due.saturating_duration_since(Instant::now())));
        }
    })
}

/// Refuses a point that takes more memory than this worker may have; another may have more.
fn too_large(scenario: &Scenario) -> Option<ComputeError> {
    let runs_at_once = if scenario.cost_study.is_some() { parallel_threads() } else { 1 };
    let needed = Footprint::of(scenario).ok()?.memory_bytes * runs_at_once as u64;
    let memory = Memory::now()?;
    (needed > memory.limit.saturating_sub(memory.resident))
        .then_some(ComputeError::TooLarge { needed, limit: memory.limit })
}

/// Progress of an earlier worker on a point. Without it the point starts from its beginning, which costs time and nothing else.
async fn read_suspended(store: &Store, blob: Option<BlobId>, scratch: &Path) -> Option<Suspended> {
    let blob = blob?;
    let read = async {
        let file = tempfile::tempfile_in(scratch).map_err(SuspendedError::from)?;
        Ok::<_, KeepError>(Suspended::from_file(store.blobs().get_into(blob, file).await?)?)
    };
    read.await
        .inspect_err(
            |error| tracing::warn!(%error, "a suspended run cannot be used; the point starts from its beginning"),
        )
        .ok()
}

/// A failure as it is stored.
fn text_of(error: &PointError) -> String {
    json!(error).to_string()
}

/// Writes the end of a point that was asked to stop before its end.
async fn halted(
    store: &Store,
    lease: &Lease,
    suspended: Option<&mut Suspended>,
    reason: StopReason,
    halt: Halt,
) -> drillsweep_store::Result<(Outcome, bool)> {
    Ok(match (reason, halt) {
        (StopReason::LeaseLost, _) => (Outcome::Lost, false),
        (StopReason::Cancelled, _) => {
            let error = PointError::new(FailureClass::Cancelled, "cancelled");
            (Outcome::Cancelled, store.finish_cancelled(lease, &text_of(&error)).await?)
        }
        (StopReason::None, Halt::Timeout(time)) => {
            let reason = format!("it exceeded the worker's time limit of {} s", time.as_secs_f64());
            if let Some(blob) = write_suspended(store, suspended).await {
                store.keep_checkpoint(lease, blob).await?;
            }
            let error = PointError::new(FailureClass::Timeout, reason);
            (Outcome::Failed, store.finish_failed(lease, &text_of(&error)).await?)
        }
        (StopReason::None, Halt::Stop | Halt::No) => {
            if let Some(blob) = write_suspended(store, suspended).await {
                store.keep_checkpoint(lease, blob).await?;
            }
            (Outcome::Suspended, store.release(lease).await?)
        }
    })
}

/// Writes a suspended run as a blob, before any row refers to it; none if it cannot be written.
async fn write_suspended(store: &Store, suspended: Option<&mut Suspended>) -> Option<BlobId> {
    let suspended = suspended?;
    let write = async {
        let file = suspended.to_file().map_err(SuspendedError::from)?;
        Ok::<_, KeepError>(store.put_blob_file(file).await?.0)
    };
    write
        .await
        .inspect_err(
            |error| tracing::warn!(%error, "a suspended run cannot be written; the point will start from its beginning"),
        )
        .ok()
}

/// Errors of keeping and resuming suspended runs.
#[derive(Debug, thiserror::Error)]
enum KeepError {
    /// Failure of its file.
    #[error(transparent)]
    File(#[from] SuspendedError),
    /// Failure of the store.
    #[error(transparent)]
    Store(#[from] StoreError),
}

fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "without a message".to_owned())
}

fn hex(key: &[u8; 32]) -> String {
    key.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A worker may be stopped before its first heartbeat.
    #[test]
    fn a_worker_that_ends_leaves_the_register() {
        let directory = tempfile::tempdir().unwrap();
        let config = WorkerConfig {
            drain: true,
            scratch: directory.path().to_owned(),
            ..WorkerConfig::new(StoreConfig::in_directory(directory.path(), Role::Worker))
        };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let store = Store::open(&config.store).await.unwrap();
            let speed = json!({ "instructions_per_second": 1.0 }).to_string();
            store.keep_machine_speed("here", i64::from(PHYSICS_VERSION), &speed).await.unwrap();
            for is_stopped in [true, false] {
                for _ in 0..10 {
                    let (_stop, stopped) = watch::channel(is_stopped);
                    run(config.clone(), stopped).await.unwrap();
                    assert_eq!(store.workers(i64::MAX / 2).await.unwrap(), []);
                }
            }
        });
    }
}
