//! Configuration of the service, and state shared by its handlers.

pub(crate) mod bodies;
pub(crate) mod columns;
pub(crate) mod expansions;
pub(crate) mod lane;
pub(crate) mod limit;
pub(crate) mod metrics;
pub(crate) mod pictures;
pub(crate) mod readiness;
pub(crate) mod retention;
pub(crate) mod shares;
pub(crate) mod tables;

use std::sync::Arc;
use std::time::Duration;

use axum::response::Response;
use drillsweep_api::LIMITS;
use drillsweep_api::judgement::OperatingLimits;
use drillsweep_store::Store;
use tokio::sync::watch;

use crate::answer::body::MEMORY_OF_BODY;
use crate::answer::chunk::Allowance;
use crate::answer::error::Result;
use crate::answer::format::{Answer, Format};
use crate::answer::need::Need;
use crate::answer::stored::MEMORY_OF_FILE;
use crate::app::bodies::Bodies;
use crate::app::columns::KnownColumns;
use crate::app::expansions::{ExpansionLimits, Expansions};
use crate::app::lane::{Lane, Place};
use crate::app::limit::{OwnerLimits, RequestLimiter};
use crate::app::metrics::{Metrics, Occupancy};
use crate::app::pictures::Pictures;
use crate::app::readiness::Readiness;
use crate::app::retention::RetentionConfig;
use crate::app::shares::Shares;
use crate::app::tables::Tables;
use crate::guard::invalid_tokens::InvalidTokens;
use crate::listen::ConnectionLimits;

/// Largest number of open event streams, and of long polls; each reads the store some times a second.
const HELD_ANSWERS: usize = 1_000;

/// Configuration of the service.
#[derive(Debug, Clone)]
pub struct Config {
    /// Interval at which points of dead workers are queued again.
    pub reap_interval: Duration,
    /// Interval at which long polls look for changes.
    pub poll_interval: Duration,
    /// Time that open requests have to end when the service stops.
    pub drain_timeout: Duration,
    /// Limits of one owner.
    pub owner_limits: OwnerLimits,
    /// Retention of data.
    pub retention: RetentionConfig,
    /// Limits on the number of connections, and timeouts.
    pub connections: ConnectionLimits,
    /// Memory of all large request bodies \[bytes\], half of it for one owner.
    pub body_bytes: usize,
    /// Limits of expansions and plans of sweeps.
    pub expansions: ExpansionLimits,
    /// Number of large answers (tables, pictures, views of histories) that are computed at once.
    pub large_answers: usize,
    /// Memory of all large answers \[bytes\]. Half as much in addition is reserved for answers of at most a quarter of it, and as much for
    /// stored files.
    pub large_answer_bytes: usize,
    /// Number of requests for large answers that may wait; further ones are refused with a Retry-After.
    pub large_answers_waiting: usize,
    /// Limits by which points are judged; a request may change them for its answer.
    pub operating_limits: OperatingLimits,
    /// Time that a client may keep a large answer waiting, which is renewed at 32 kB/s; slower clients are broken off.
    pub large_answer_allowance: Duration,
}

impl Default for Config {
    fn default() -> Self {
        let cores = std::thread::available_parallelism().map_or(2, std::num::NonZero::get);
        Config {
            reap_interval: Duration::from_secs(5),
            poll_interval: Duration::from_millis(200),
            drain_timeout: Duration::from_secs(10),
            owner_limits: OwnerLimits::default(),
            retention: RetentionConfig::default(),
            connections: ConnectionLimits::default(),
            body_bytes: 2 * LIMITS.body_bytes,
            expansions: ExpansionLimits {
                at_once: cores,
                bytes: 100 << 20,
                waiting: 256,
                deadline: Duration::from_secs(5),
            },
            large_answers: cores,
            large_answer_bytes: 40 << 20,
            large_answers_waiting: 256,
            operating_limits: OperatingLimits::default(),
            large_answer_allowance: Duration::from_secs(30),
        }
    }
}

/// State shared by the handlers.
#[derive(Clone)]
pub(crate) struct App {
    pub(crate) store: Store,
    pub(crate) config: Arc<Config>,
    /// True once the service stops; long polls and event streams then end.
    pub(crate) stopping: watch::Receiver<bool>,
    pub(crate) limiter: Arc<RequestLimiter>,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) readiness: Arc<Readiness>,
    /// Places for event streams.
    pub(crate) streams: Arc<Shares>,
    /// Places for long polls.
    pub(crate) polls: Arc<Shares>,
    /// Addresses that send invalid tokens.
    pub(crate) invalid_tokens: Arc<InvalidTokens>,
    pub(crate) columns: Arc<KnownColumns>,
    pub(crate) tables: Arc<Tables>,
    pictures: Arc<Pictures>,
    /// Memory for views of results \[KiB\].
    views: Arc<Lane>,
    /// Memory for small views, which do not wait for large ones \[KiB\].
    small_views: Arc<Lane>,
    /// Memory for stored files \[KiB\].
    files: Arc<Lane>,
    /// Places for expansions, plans and modes, which search an equilibrium.
    pub(crate) expansions: Arc<Expansions>,
    /// Memory for bodies of requests.
    pub(crate) bodies: Arc<Bodies>,
}

impl App {
    pub(crate) fn new(store: Store, config: Config, stopping: watch::Receiver<bool>) -> Self {
        let lane = |units| {
            let allowance = config.large_answer_allowance;
            Arc::new(Lane::new(units, config.large_answers, config.large_answers_waiting, allowance))
        };
        let metrics = Metrics::new(&store);
        let invalid_tokens = InvalidTokens::new(metrics.refused_tokens.clone());
        App {
            store,
            limiter: Arc::new(RequestLimiter::new(&config.owner_limits)),
            metrics: Arc::new(metrics),
            readiness: Arc::default(),
            streams: Shares::new("event streams", HELD_ANSWERS, LIMITS.held_answers_per_owner),
            polls: Shares::new("long polls", HELD_ANSWERS, LIMITS.held_answers_per_owner),
            invalid_tokens: Arc::new(invalid_tokens),
            columns: Arc::default(),
            tables: Arc::new(Tables::new()),
            pictures: Arc::new(Pictures::new()),
            views: lane(config.large_answer_bytes / KIB),
            small_views: lane(config.large_answer_bytes / 2 / KIB),
            files: lane(config.large_answer_bytes / 2 / KIB),
            expansions: Expansions::new(config.expansions.clone(), stopping.clone()),
            bodies: Bodies::new(config.body_bytes),
            stopping,
            config: Arc::new(config),
        }
    }

    /// Takes memory for a view of a result and its body.
    pub(crate) async fn view(&self, need: impl Into<Need>) -> Result<Place> {
        let need = need.into();
        let memory = kibibytes(need.bytes.saturating_add(MEMORY_OF_BODY));
        if need.is_long || memory > self.config.large_answer_bytes / 4 / KIB {
            return self.views.enter(memory).await;
        }
        let free = self.small_views.try_enter(memory).or_else(|| self.views.try_enter(memory));
        match free {
            Some(place) => Ok(place),
            None => self.small_views.enter(memory).await,
        }
    }

    /// Use of all bounded resources, by name.
    pub(crate) fn lanes(&self) -> [(&'static str, Occupancy); 5] {
        [
            ("views", self.views.measure(KIB)),
            ("small_views", self.small_views.measure(KIB)),
            ("files", self.files.measure(KIB)),
            ("expansions", self.expansions.measure()),
            ("bodies", self.bodies.measure()),
        ]
    }

    /// Answers with the result of `prepare`, which runs in a place of the needed memory; a picture is cached under `key`.
    pub(crate) async fn answer(
        &self,
        format: Format,
        key: &str,
        need: impl Into<Need>,
        prepare: impl FnOnce() -> Result<Answer> + Send + 'static,
    ) -> Result<Response> {
        if !format.is_picture() {
            return self.view(need).await?.answer(prepare).await;
        }
        let draw = async { self.view(need).await?.make(prepare).await };
        self.pictures.get_or_draw(key, draw).await
    }

    /// Takes memory for a stored file, with the allowance of its client.
    pub(crate) async fn file(&self) -> Result<(impl Send + 'static, Allowance)> {
        Ok(self.files.enter(kibibytes(MEMORY_OF_FILE)).await?.into_parts())
    }
}

const KIB: usize = 1 << 10;

fn kibibytes(bytes: u64) -> usize {
    usize::try_from(bytes).unwrap_or(usize::MAX).div_ceil(KIB)
}
