//! The heartbeat: renews the lease of the running point, from an OS thread with its own connection and of normal priority, whereas
//! computing threads have a low one.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use drillsweep_sim::control::Control;
use drillsweep_store::{Lease, Renewal, Store, StoreConfig, WorkerRecord};

use crate::memory::Memory;
use crate::metrics::Metrics;

/// Renewals per lease: two may fail before it runs out.
const RENEWALS_PER_LEASE: u32 = 3;

/// A point whose lease is kept.
#[derive(Debug, Clone)]
pub(crate) struct Watched {
    pub(crate) lease: Lease,
    pub(crate) control: Arc<Control>,
    /// Simulated time of all its runs \[s\].
    pub(crate) duration: f64,
    pub(crate) verdict: Arc<Verdict>,
}

/// Reason for which a point was requested to stop, if it was.
#[derive(Debug, Default)]
pub(crate) struct Verdict(AtomicU8);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StopReason {
    /// No request.
    None,
    /// Its sweep was cancelled.
    Cancelled,
    /// Its lease is lost.
    LeaseLost,
}

impl Verdict {
    pub(crate) fn get(&self) -> StopReason {
        match self.0.load(Ordering::Acquire) {
            0 => StopReason::None,
            1 => StopReason::Cancelled,
            _ => StopReason::LeaseLost,
        }
    }

    fn set(&self, reason: StopReason) {
        let code = match reason {
            StopReason::None => 0,
            StopReason::Cancelled => 1,
            StopReason::LeaseLost => 2,
        };
        self.0.store(code, Ordering::Release);
    }
}

/// The running heartbeat thread.
pub(crate) struct Heartbeat {
    jobs: Option<mpsc::Sender<Option<Watched>>>,
    thread: Option<JoinHandle<()>>,
}

impl Heartbeat {
    /// Starts the thread, which keeps the entry of `worker` in the register fresh, while idle too, until it is dropped.
    pub(crate) fn start(
        config: StoreConfig,
        worker: WorkerRecord,
        lease: Duration,
        metrics: Metrics,
    ) -> std::io::Result<Self> {
        let (jobs, inbox) = mpsc::channel();
        let thread = std::thread::Builder::new()
            .name("heartbeat".to_owned())
            .spawn(move || beat(&config, &worker, lease, &inbox, &metrics))?;
        Ok(Self { jobs: Some(jobs), thread: Some(thread) })
    }

    /// Keeps the lease of a point from now on, or of none.
    pub(crate) fn watch(&self, point: Option<Watched>) {
        if let Some(jobs) = &self.jobs {
            // A thread that has ended is noticed when the lease runs out: the write is then refused.
            let _ = jobs.send(point);
        }
    }
}

impl Drop for Heartbeat {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn beat(
    config: &StoreConfig,
    worker: &WorkerRecord,
    lease: Duration,
    inbox: &mpsc::Receiver<Option<Watched>>,
    metrics: &Metrics,
) {
    let runtime = match tokio::runtime::Builder::new_current_thread().enable_all().build() {
        Ok(runtime) => runtime,
        Err(error) => {
            tracing::error!(%error, "no heartbeat: its runtime cannot be built");
            return;
        }
    };
    let lease_ms = lease.as_millis() as i64;
    let interval = lease / RENEWALS_PER_LEASE;
    let mut store: Option<Store> = None;
    let mut point: Option<Watched> = None;
    let mut renewed = Instant::now();
    let mut next = Instant::now();
    loop {
        match inbox.recv_timeout(next.saturating_duration_since(Instant::now())) {
            Ok(watched) => {
                // The next beat stays when it was due: a worker of many short points must send heartbeats too.
                point = watched;
                renewed = Instant::now();
                continue;
            }
            Err(RecvTimeoutError::Disconnected) => {
                if let Some(store) = store {
                    runtime.block_on(store.close());
                }
                return;
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        next = Instant::now() + interval;
        if let Err(error) = runtime.block_on(renew(config, worker, lease_ms, &mut store, point.as_ref())) {
            metrics.heartbeat_failures.inc();
            tracing::warn!(%error, "a heartbeat failed");
            // Better to lose the work than to compute as a zombie.
            if let Some(point) = point.as_ref().filter(|_| renewed.elapsed() * 2 > lease) {
                point.verdict.set(StopReason::LeaseLost);
                point.control.cancel();
            }
            next = Instant::now() + interval / 4;
        } else {
            renewed = Instant::now();
        }
    }
}

async fn renew(
    config: &StoreConfig,
    worker: &WorkerRecord,
    lease_ms: i64,
    store: &mut Option<Store>,
    point: Option<&Watched>,
) -> drillsweep_store::Result<()> {
    if store.is_none() {
        *store = Some(Store::open(config).await?);
    }
    let Some(store) = store else { return Ok(()) };
    store.register_worker(worker).await?;
    let Some(point) = point else { return Ok(()) };
    let progress = if point.duration > 0.0 { point.control.simulated_time() / point.duration } else { 0.0 };
    let progress = progress.clamp(0.0, 1.0);
    if let Some(note) = Memory::now().and_then(Memory::note) {
        store.note_worker(&point.lease, &note).await?;
    }
    let reason = match store.renew(&point.lease, lease_ms, progress).await? {
        Renewal::Held => return Ok(()),
        Renewal::CancelRequested => StopReason::Cancelled,
        Renewal::Lost => StopReason::LeaseLost,
    };
    tracing::info!(?reason, "the running point is stopped");
    point.verdict.set(reason);
    point.control.cancel();
    Ok(())
}

#[cfg(test)]
mod tests {
    use drillsweep_store::Role;

    use super::*;

    #[test]
    fn a_worker_of_many_short_points_sends_its_heartbeat() {
        let directory = tempfile::tempdir().unwrap();
        let config = StoreConfig::in_directory(directory.path(), Role::Worker);
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        let store = runtime.block_on(Store::open(&config)).unwrap();
        let worker = WorkerRecord {
            id: "busy".to_owned(),
            host: "here".to_owned(),
            process: 1,
            version: "1".to_owned(),
            physics_version: 1,
            started: 0,
            last_seen: 0,
        };
        runtime.block_on(store.register_worker(&worker)).unwrap();
        let last_seen = || runtime.block_on(store.workers(i64::MAX / 2)).unwrap()[0].last_seen;
        let (first, patience) = (last_seen(), Instant::now() + Duration::from_secs(30));
        let heartbeat =
            Heartbeat::start(config, worker, Duration::from_millis(300), Metrics::default()).unwrap();
        while last_seen() < first + 500 {
            assert!(Instant::now() < patience, "never heard of again");
            heartbeat.watch(None);
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}
