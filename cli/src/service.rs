//! The roles of the binary that keep running: server, worker, and both together.

use std::ffi::OsStr;
use std::fs::DirBuilder;
use std::io::Write as _;
use std::net::SocketAddr;
use std::num::NonZeroU32;
use std::os::unix::fs::DirBuilderExt as _;
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::path::PathBuf;
use std::process::{ExitStatus, Stdio};
use std::time::Duration;

use anyhow::Context;
use clap::Args;
use drillsweep_api::judgement::OperatingLimits;
use drillsweep_api::time_span;
use drillsweep_server::{
    Config, ConnectionLimits, DEFAULT_ADDRESS, Exposition, Listeners, OwnerLimits, RetentionConfig,
};
use drillsweep_store::{Role, Store, StoreConfig, with_backoff};
use drillsweep_worker::{WorkerConfig, host_name};
use rustix::process::{Resource, Rlimit, Signal, getrlimit, set_parent_process_death_signal, setrlimit};
use tokio::net::TcpListener;
use tokio::process::{Child, Command};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::watch;
use tokio::task::JoinSet;

use crate::banner::Banner;
use crate::data::DataArguments;
use crate::gc::RetentionArguments;
use crate::token;

/// Time for children to give their points back: as long as open requests have to end.
const CHILD_GRACE: Duration = Duration::from_secs(10);

/// Time for the database to close, and then for blocking threads to return, before the process ends without them.
const LAST_GRACE: Duration = Duration::from_secs(1);

/// Addresses and limits of the server.
#[derive(Args, Clone)]
struct ListenArguments {
    /// Address to listen on; anything but this machine needs a token first (`drillsweep token create`).
    #[arg(long, value_name = "ADDRESS", env = "DRILLSWEEP_LISTEN", default_value_t = DEFAULT_ADDRESS)]
    listen: SocketAddr,
    /// Address on which `/metrics` is served, without tokens; absent means none.
    #[arg(long, value_name = "ADDRESS", env = "DRILLSWEEP_METRICS_LISTEN")]
    metrics_listen: Option<SocketAddr>,
    /// File with an administrator's token that was made elsewhere: 32 to 200 visible ASCII characters.
    #[arg(long, value_name = "FILE", env = "DRILLSWEEP_ADMIN_TOKEN_FILE")]
    admin_token_file: Option<PathBuf>,
    /// Requests that an owner may make per second, on average.
    #[arg(long, value_name = "NUMBER", default_value_t = OwnerLimits::default().requests_per_second)]
    requests_per_second: NonZeroU32,
    /// Requests that an owner may make at once (the size of the token bucket).
    #[arg(long, value_name = "NUMBER", default_value_t = OwnerLimits::default().request_burst)]
    request_burst: NonZeroU32,
    /// Interval of garbage collection, such as `24h`; `0` leaves it to `drillsweep gc`.
    #[arg(long, value_name = "TIME_SPAN", env = "DRILLSWEEP_RETENTION_INTERVAL", default_value = "24h", value_parser = parse_interval)]
    retention_interval: Duration,
    #[command(flatten)]
    retention: RetentionArguments,
    /// Connections that may be open at once; beyond them is a reserve for health checks.
    #[arg(long, value_name = "NUMBER", default_value_t = ConnectionLimits::default().total)]
    connections: usize,
    /// Connections that one address may have open at once; those of this machine, where a reverse proxy may be, are not counted.
    #[arg(long, value_name = "NUMBER", default_value_t = ConnectionLimits::default().per_address)]
    connections_per_address: usize,
    /// Points of an owner that may be queued or running.
    #[arg(long, value_name = "NUMBER", default_value_t = OwnerLimits::default().open_points)]
    open_points: u64,
    /// Changes of the limits by which points are judged: `COLUMN:VALUE` in SI units or `COLUMN:off`, separated by commas.
    #[arg(
        long,
        value_name = "LIMITS",
        env = "DRILLSWEEP_OPERATING_LIMITS",
        value_parser = OperatingLimits::parse,
        default_value = "",
        hide_default_value = true
    )]
    operating_limits: OperatingLimits,
}

#[derive(Args)]
pub(crate) struct UpArguments {
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    listen: ListenArguments,
    /// First address on which workers serve `/metrics`, without tokens: consecutive ports, one for each worker.
    #[arg(long, value_name = "ADDRESS", env = "DRILLSWEEP_WORKER_METRICS_LISTEN")]
    worker_metrics_listen: Option<SocketAddr>,
    /// Number of worker processes; one per core by default.
    #[arg(long, value_name = "NUMBER")]
    workers: Option<usize>,
    /// Lease of a worker on its point, in seconds: a silent worker's point is queued again after that.
    #[arg(long, value_name = "SECONDS", env = "DRILLSWEEP_LEASE_SECONDS", default_value_t = 60.0)]
    lease_seconds: f64,
    /// Time limit of one attempt at a point, such as `30m`; unlimited by default.
    #[arg(long, value_name = "TIME_SPAN", value_parser = parse_span)]
    point_timeout: Option<Duration>,
    #[command(flatten)]
    scratch: ScratchArguments,
}

#[derive(Args)]
struct ScratchArguments {
    /// Directory for temporary files, which hold the records of a running point: up to 7 GiB a worker, on a disk of its own machine; `scratch`
    /// in the data directory unless given.
    #[arg(long, value_name = "DIRECTORY", env = "DRILLSWEEP_SCRATCH")]
    scratch: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct ServeArguments {
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    listen: ListenArguments,
}

#[derive(Args)]
pub(crate) struct WorkerArguments {
    #[command(flatten)]
    data: DataArguments,
    /// Lease of a worker on its point, in seconds: a silent worker's point is queued again after that.
    #[arg(long, value_name = "SECONDS", env = "DRILLSWEEP_LEASE_SECONDS", default_value_t = 60.0)]
    lease_seconds: f64,
    /// End when no point is left to claim.
    #[arg(long)]
    drain: bool,
    /// End after this time, such as `3h`, `90m` or `600s`; the running point is suspended with a checkpoint, from which
    /// another worker continues.
    #[arg(long, value_name = "TIME_SPAN", value_parser = parse_span)]
    max_runtime: Option<Duration>,
    /// Time limit of one attempt at a point, such as `30m`; unlimited by default.
    #[arg(long, value_name = "TIME_SPAN", value_parser = parse_span)]
    point_timeout: Option<Duration>,
    /// Address on which `/metrics` is served, without tokens; absent means none.
    #[arg(long, value_name = "ADDRESS", env = "DRILLSWEEP_WORKER_METRICS_LISTEN")]
    metrics_listen: Option<SocketAddr>,
    #[command(flatten)]
    scratch: ScratchArguments,
    /// Largest number of simulated seconds per second: slows points down, for tests of stopped or lost runs.
    #[arg(long, env = "DRILLSWEEP_PACE", hide = true, value_parser = parse_pace)]
    pace: Option<f64>,
    /// Claim points of another version of the physics, as a worker of another version does.
    #[cfg(debug_assertions)]
    #[arg(long, hide = true, default_value_t = drillsweep_sim::PHYSICS_VERSION)]
    physics_version: u32,
    /// End when the process that started this one ends.
    #[arg(long, hide = true)]
    with_parent: bool,
}

impl UpArguments {
    /// The address of a worker's metrics.
    fn worker_metrics_listen(&self, index: usize) -> anyhow::Result<Option<SocketAddr>> {
        let Some(first) = self.worker_metrics_listen else { return Ok(None) };
        let port = u16::try_from(index).ok().and_then(|index| first.port().checked_add(index));
        let port = port.context("--worker-metrics-listen leaves no port for the last worker")?;
        Ok(Some(SocketAddr::new(first.ip(), port)))
    }
}

impl ScratchArguments {
    /// The directory, which is made if it is not there.
    fn directory(&self, data: &DataArguments) -> anyhow::Result<PathBuf> {
        let directory = self.scratch.clone().unwrap_or_else(|| data.scratch());
        // Only this user has access, as to all data.
        let make = DirBuilder::new().recursive(true).mode(0o700).create(&directory);
        make.with_context(|| format!("cannot make {}", directory.display()))?;
        Ok(directory)
    }
}

/// Server and workers on one machine: the workers start once the server listens, and all end as soon as either part does.
pub(crate) fn up(arguments: &UpArguments) -> anyhow::Result<()> {
    bound_memory();
    lease(arguments.lease_seconds)?;
    let workers = match arguments.workers {
        Some(number) => number,
        None => std::thread::available_parallelism()?.get(),
    };
    run_service(async {
        let stop = stop_on_signal()?;
        let Some(service) = Service::open(&arguments.data, &arguments.listen, &stop).await? else {
            return Ok(());
        };
        arguments.scratch.directory(&arguments.data)?;
        let banner =
            Banner { address: service.listeners.api.local_addr()?, data: arguments.data.places(), workers };
        // A closed standard output is no reason to end.
        let _ = writeln!(std::io::stdout().lock(), "{banner}");
        let serving = stopping_others(service.run(stop.subscribe()), &stop);
        let keeping = stopping_others(keep_workers(arguments, workers, &stop), &stop);
        let (served, kept) = tokio::join!(serving, keeping);
        if let (Err(_), Err(error)) = (&served, &kept) {
            tracing::error!("{error:#}");
        }
        served.and(kept)
    })
}

/// Requests the other parts to end once this one has ended.
async fn stopping_others<T>(part: impl Future<Output = T>, stop: &watch::Sender<bool>) -> T {
    let ended = part.await;
    stop.send_replace(true);
    ended
}

/// The server alone.
pub(crate) fn serve(arguments: &ServeArguments) -> anyhow::Result<()> {
    bound_memory();
    run_service(async {
        let stop = stop_on_signal()?;
        match Service::open(&arguments.data, &arguments.listen, &stop).await? {
            Some(service) => service.run(stop.subscribe()).await,
            None => Ok(()),
        }
    })
}

/// A worker.
pub(crate) fn worker(arguments: &WorkerArguments) -> anyhow::Result<()> {
    if arguments.with_parent {
        set_parent_process_death_signal(Some(Signal::TERM))
            .context("the worker cannot follow the process that started it")?;
    }
    let exposition = arguments.metrics_listen.map(|address| (address, Exposition::new()));
    let config = WorkerConfig {
        registry: exposition.as_ref().map(|(_, exposition)| exposition.registry().clone()),
        lease: lease(arguments.lease_seconds)?,
        drain: arguments.drain,
        max_runtime: arguments.max_runtime,
        point_timeout: arguments.point_timeout,
        pace: arguments.pace,
        #[cfg(debug_assertions)]
        physics_version: arguments.physics_version,
        scratch: arguments.scratch.directory(&arguments.data)?,
        ..WorkerConfig::new(arguments.data.store(Role::Worker)?)
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        if let Some((address, exposition)) = exposition {
            tokio::spawn(exposition.serve(bind(address).await?));
        }
        Ok(drillsweep_worker::run(config, stop_on_signal()?.subscribe()).await?)
    })
}

/// Settings of glibc's allocator for a server. By default freed memory stays in up to eight arenas a core, and blocks below a threshold
/// that grows to 32 MiB are not returned to the system: after large answers that is several times their size.
const ALLOCATOR: [(&str, &str); 2] = [("MALLOC_ARENA_MAX", "2"), ("MALLOC_MMAP_THRESHOLD_", "1048576")];

/// Starts this program again in the same process with those settings of the [`ALLOCATOR`] that the environment lacks: glibc reads them at the start only.
/// If that fails, the server takes more memory.
fn bound_memory() {
    let is_given = |(setting, _): &(&str, &str)| std::env::var_os(setting).is_some();
    if cfg!(not(target_env = "gnu")) || ALLOCATOR.iter().all(is_given) {
        return;
    }
    let Ok(program) = std::env::current_exe() else { return };
    let missing = ALLOCATOR.into_iter().filter(|setting| !is_given(setting));
    let error = std::process::Command::new(program).args(std::env::args_os().skip(1)).envs(missing).exec();
    tracing::warn!(%error, "the server may take more memory than it needs");
}

fn lease(seconds: f64) -> anyhow::Result<Duration> {
    anyhow::ensure!(
        (1.0..=3600.0).contains(&seconds),
        "--lease-seconds must be from 1 to 3600, got {seconds}"
    );
    Ok(Duration::from_secs_f64(seconds))
}

/// A time span above 0: `3h`, `90m`, `600s`, or seconds as a number.
fn parse_span(text: &str) -> anyhow::Result<Duration> {
    let span = time_span::parse(text).ok().filter(|span| !span.is_zero());
    span.with_context(|| format!("write a time span such as 3h, 90m or 600s, got {text:?}"))
}

fn parse_pace(text: &str) -> anyhow::Result<f64> {
    let pace = text.parse().ok().filter(|pace| (1e-3..=1e6).contains(pace));
    pace.with_context(|| format!("write a number from 0.001 to 1e6, got {text:?}"))
}

/// A time span, or 0 for never.
fn parse_interval(text: &str) -> anyhow::Result<Duration> {
    if text == "0" { Ok(Duration::ZERO) } else { parse_span(text) }
}

/// Runs a service to its end.
fn run_service(service: impl Future<Output = anyhow::Result<()>>) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let ended = runtime.block_on(service);
    // Dropping the runtime would wait for computations of requests that have been cut off; a blocking thread cannot be interrupted.
    runtime.shutdown_timeout(LAST_GRACE);
    ended
}

/// A channel that turns true on SIGTERM or Ctrl-C.
fn stop_on_signal() -> anyhow::Result<watch::Sender<bool>> {
    let stop = watch::Sender::new(false);
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    let stopping = stop.clone();
    tokio::spawn(async move {
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
        stopping.send_replace(true);
    });
    Ok(stop)
}

async fn stopped(mut stop: watch::Receiver<bool>) {
    // The sender lives until it has sent true.
    let _ = stop.wait_for(|stop| *stop).await;
}

/// A server that listens, with the store that it serves.
struct Service {
    store: Store,
    listeners: Listeners,
    config: Config,
}

impl Service {
    /// Opens a service; `None` if it is stopped before that.
    async fn open(
        data: &DataArguments,
        arguments: &ListenArguments,
        stop: &watch::Sender<bool>,
    ) -> anyhow::Result<Option<Self>> {
        tokio::select! {
            service = Self::listening(data, arguments) => Ok(Some(service?)),
            () = stopped(stop.subscribe()) => Ok(None),
        }
    }

    /// Opens the store and takes the addresses, if the server may listen on them.
    async fn listening(data: &DataArguments, arguments: &ListenArguments) -> anyhow::Result<Self> {
        let config = data.store(Role::Server)?;
        let store = with_backoff(|| Store::open(&config)).await?;
        store.check_certificate().await?;
        for exposed in data.exposed(&config) {
            tracing::warn!("{exposed}");
        }
        if let Some(path) = &arguments.admin_token_file {
            token::register(&store, path).await?;
        }
        let metrics = match arguments.metrics_listen {
            Some(address) => Some(bind(address).await?),
            None => None,
        };
        let listeners = Listeners { api: bind(arguments.listen).await?, metrics };
        listeners.check(&store).await?;
        let config = Config {
            owner_limits: OwnerLimits {
                requests_per_second: arguments.requests_per_second,
                request_burst: arguments.request_burst,
                open_points: arguments.open_points,
            },
            connections: ConnectionLimits {
                total: arguments.connections.min(room_for_connections()),
                per_address: arguments.connections_per_address,
                ..ConnectionLimits::default()
            },
            retention: RetentionConfig {
                policy: arguments.retention.policy(),
                interval: Some(arguments.retention_interval).filter(|interval| !interval.is_zero()),
            },
            operating_limits: arguments.operating_limits.clone(),
            ..Config::default()
        };
        Ok(Self { store, listeners, config })
    }

    /// Serves until `stop` turns true.
    async fn run(self, stop: watch::Receiver<bool>) -> anyhow::Result<()> {
        let served =
            drillsweep_server::serve(self.listeners, self.store.clone(), self.config, stopped(stop)).await;
        // A request that was cut off may hold a connection; the next start folds the write-ahead log in.
        if tokio::time::timeout(LAST_GRACE, self.store.close()).await.is_err() {
            tracing::warn!("the database was not closed in time");
        }
        Ok(served?)
    }
}

/// Number of connections that the system's limit of open files permits. The limit is raised as far as this process may.
fn room_for_connections() -> usize {
    /// Files for the database, stored files, the reserve of connections, and the parent process.
    const OTHERS: u64 = 300;
    /// Largest limit that is set.
    const ENOUGH: u64 = 65_536;
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    let (current, raised) = (current.unwrap_or(ENOUGH), maximum.unwrap_or(ENOUGH).min(ENOUGH));
    let is_raised =
        raised > current && setrlimit(Resource::Nofile, Rlimit { current: Some(raised), maximum }).is_ok();
    let files = if is_raised { raised } else { current };
    usize::try_from(files.saturating_sub(OTHERS)).unwrap_or(usize::MAX).max(100)
}

async fn bind(address: SocketAddr) -> anyhow::Result<TcpListener> {
    TcpListener::bind(address).await.with_context(|| format!("cannot listen on {address}"))
}

/// Keeps a number of worker processes alive until a request to stop. If one cannot be kept, all are stopped.
async fn keep_workers(
    arguments: &UpArguments,
    number: usize,
    stop: &watch::Sender<bool>,
) -> anyhow::Result<()> {
    let commands: Vec<Command> =
        (0..number).map(|index| worker_command(arguments, index)).collect::<anyhow::Result<_>>()?;
    let mut keepers = JoinSet::new();
    for command in commands {
        let store = arguments.data.store(Role::Server)?;
        let stop = stop.subscribe();
        keepers.spawn(async move { keep_worker(command, &store, stop).await });
    }
    if number == 0 {
        // The workers of other machines compute.
        stopped(stop.subscribe()).await;
    }
    let mut kept = Ok(());
    while let Some(ended) = keepers.join_next().await {
        let ended = ended.map_err(anyhow::Error::from).flatten();
        if ended.is_err() {
            stop.send_replace(true);
        }
        kept = kept.and(ended);
    }
    kept
}

fn worker_command(arguments: &UpArguments, index: usize) -> anyhow::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    command.arg("worker").arg("--with-parent");
    if let Some(address) = arguments.worker_metrics_listen(index)? {
        // A worker that ends since its address is taken would be started again and again.
        drop(std::net::TcpListener::bind(address).with_context(|| format!("cannot listen on {address}"))?);
        command.arg("--metrics-listen").arg(address.to_string());
    }
    arguments.data.hand_on(&mut command);
    command
        .arg("--lease-seconds")
        .arg(arguments.lease_seconds.to_string())
        .args(
            arguments
                .point_timeout
                .iter()
                .flat_map(|time| ["--point-timeout".to_owned(), time.as_secs_f64().to_string()]),
        )
        .args(arguments.scratch.scratch.iter().flat_map(|path| [OsStr::new("--scratch"), path.as_os_str()]))
        .stdin(Stdio::null())
        // Ctrl-C reaches the whole group: the parent decides when its workers end.
        .process_group(0);
    Ok(command)
}

async fn keep_worker(
    mut command: Command,
    store: &StoreConfig,
    stop: watch::Receiver<bool>,
) -> anyhow::Result<()> {
    while !*stop.borrow() {
        let kills = memory_kills();
        let mut child = command.spawn().context("a worker cannot be started")?;
        let process = child.id();
        tokio::select! {
            status = child.wait() => {
                let note = how_it_ended(status?, memory_kills() > kills);
                tracing::warn!("a worker {note}; a new one is started");
                if let Some(process) = process && let Err(error) = bury(store, process, &note).await {
                    tracing::warn!(%error, "its point is queued again when its lease expires");
                }
                tokio::select! {
                    () = tokio::time::sleep(Duration::from_secs(1)) => {}
                    () = stopped(stop.clone()) => {}
                }
            }
            () = stopped(stop.clone()) => end_child(child).await?,
        }
    }
    Ok(())
}

/// Releases the points of a worker that has ended: a process that was waited for writes nothing more.
async fn bury(store: &StoreConfig, process: u32, note: &str) -> drillsweep_store::Result<()> {
    let store = Store::open(store).await?;
    store.bury_worker(&host_name(), i64::from(process), Some(note)).await?;
    store.close().await;
    Ok(())
}

/// End of a worker in words, for the log.
fn how_it_ended(status: ExitStatus, was_memory_short: bool) -> String {
    match (status.signal(), status.code()) {
        // The system ends processes with this signal when memory is short; so do people.
        (Some(9), _) if was_memory_short => "was ended by the system for lack of memory".to_owned(),
        // A failed allocation is one of the reasons; the process has written which it was to the log.
        (Some(6), _) => {
            "aborted (signal 6), as when a memory allocation fails; the workers' log has the reason"
                .to_owned()
        }
        (Some(signal), _) => format!("was ended by signal {signal}"),
        (None, code) => format!("ended with exit code {}", code.unwrap_or_default()),
    }
}

/// Number of processes that the system has ended for lack of memory since its start; 0 if it does not report it.
fn memory_kills() -> u64 {
    let counters = std::fs::read_to_string("/proc/vmstat").unwrap_or_default();
    let count = counters.lines().find_map(|line| line.strip_prefix("oom_kill "));
    count.and_then(|count| count.trim().parse().ok()).unwrap_or(0)
}

/// Requests a child to end, and kills it after a while.
async fn end_child(mut child: Child) -> anyhow::Result<()> {
    if let Some(pid) = child.id().and_then(|id| rustix::process::Pid::from_raw(id as i32)) {
        // A child that has ended already cannot be signalled, and need not be.
        let _ = rustix::process::kill_process(pid, Signal::TERM);
    }
    if tokio::time::timeout(CHILD_GRACE, child.wait()).await.is_err() {
        tracing::warn!(
            "a worker did not end in time and is killed; its point is queued again when its lease expires"
        );
        child.kill().await?;
    }
    Ok(())
}
