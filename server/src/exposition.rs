//! Metrics as Prometheus text on a separate listener, with those of the process.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use axum::Router;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use drillsweep_api::PHYSICS_VERSION;
use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::encoding::text::encode;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::{Registry, Unit};
use tokio::net::TcpListener;

use crate::answer::error::{Error, Result};
use crate::listen::{ConnectionCounts, ConnectionLimits, serve_connections};

/// The media type of [`Exposition::text`].
const TEXT: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// Metrics of a process. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Exposition {
    registry: Arc<Mutex<Registry>>,
    process: Arc<ProcessMetrics>,
}

impl Default for Exposition {
    fn default() -> Self {
        Self::new()
    }
}

impl Exposition {
    /// Metrics of the process and its build; further ones are added to [`registry`](Self::registry).
    pub fn new() -> Self {
        let mut registry = Registry::default();
        let process = ProcessMetrics::default();
        process.register(registry.sub_registry_with_prefix("process"));
        let build = Family::<BuildLabels, Gauge>::default();
        let labels = BuildLabels { version: env!("CARGO_PKG_VERSION"), physics_version: PHYSICS_VERSION };
        build.get_or_create(&labels).set(1);
        registry.sub_registry_with_prefix("drillsweep").register(
            "build_info",
            "Version of the program and of its physics",
            build,
        );
        Self { registry: Arc::new(Mutex::new(registry)), process: Arc::new(process) }
    }

    /// The registry of all metrics.
    pub fn registry(&self) -> &Arc<Mutex<Registry>> {
        &self.registry
    }

    /// Serves `/metrics` for as long as the future is polled.
    pub async fn serve(self, listener: TcpListener) {
        let routes = router(move || std::future::ready(self.text()));
        let limits = ConnectionLimits::default();
        serve_connections(listener, routes, &limits, ConnectionCounts::default(), std::future::pending())
            .await;
    }

    /// All metrics.
    pub(crate) fn text(&self) -> Result<String> {
        self.process.read();
        let registry = self.registry.lock().unwrap_or_else(PoisonError::into_inner);
        let mut text = String::new();
        encode(&mut text, &registry).map_err(|error| Error::internal(&error))?;
        Ok(text)
    }
}

/// Route `/metrics`, with the text of a function.
pub(crate) fn router<F, T>(text: F) -> Router
where
    F: Fn() -> T + Clone + Send + Sync + 'static,
    T: Future<Output = Result<String>> + Send + 'static,
{
    Router::new().route("/metrics", get(show::<F, T>)).with_state(text)
}

async fn show<F, T>(State(text): State<F>) -> Response
where
    F: Fn() -> T,
    T: Future<Output = Result<String>>,
{
    match text().await {
        Ok(text) => ([(header::CONTENT_TYPE, TEXT)], text).into_response(),
        Err(error) => error.into_response(),
    }
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct BuildLabels {
    version: &'static str,
    physics_version: u32,
}

/// Metrics of the process, by their usual names.
#[derive(Debug, Default)]
struct ProcessMetrics {
    cpu: Counter<f64, AtomicU64>,
    memory: Gauge,
    files: Gauge,
    start: Gauge<f64, AtomicU64>,
}

impl ProcessMetrics {
    fn register(&self, registry: &mut Registry) {
        registry.register_with_unit("cpu", "Processor time", Unit::Seconds, self.cpu.clone());
        registry.register_with_unit("resident_memory", "Resident memory", Unit::Bytes, self.memory.clone());
        registry.register("open_fds", "Open file descriptors", self.files.clone());
        registry.register_with_unit("start_time", "Start since the epoch", Unit::Seconds, self.start.clone());
    }

    /// Reads the metrics of the process, on systems that have them.
    fn read(&self) {
        let Ok(process) = procfs::process::Process::myself() else { return };
        if let Ok(stat) = process.stat() {
            let ticks = procfs::ticks_per_second() as f64;
            let cpu = (stat.utime + stat.stime) as f64 / ticks;
            self.cpu.inner().store(cpu.to_bits(), Ordering::Relaxed);
            self.memory.set((stat.rss * procfs::page_size()) as i64);
            if let Ok(boot) = procfs::boot_time_secs() {
                self.start.set(boot as f64 + stat.starttime as f64 / ticks);
            }
        }
        if let Ok(files) = process.fd_count() {
            self.files.set(files as i64);
        }
    }
}
