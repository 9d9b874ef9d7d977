//! State shared by the handlers, and setup of the service.

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

use std::sync::Arc;
use std::time::Duration;

use axum::response::Response;
use drillsweep_api::LIMITS;
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
use crate::guard::strangers::Strangers;
use crate::listen::ConnectionLimits;

/// Event streams, and as many long polls, that may be open at once; each looks at the store some times a second.
const HELD_ANSWERS: usize = 1_000;

/// How the service keeps house.
#[derive(Debug, Clone)]
pub struct Config {
    /// How often points of dead workers are given back to the queue.
    pub reap_interval: Duration,
    /// How often a long poll looks for a change.
    pub poll_interval: Duration,
    /// How long open requests may take to end once the service is asked to stop.
    pub drain_timeout: Duration,
    /// Limits of one owner.
    pub owner_limits: OwnerLimits,
    /// How long data are kept.
    pub retention: RetentionConfig,
    /// How many connections there may be, and how long they may take.
    pub connections: ConnectionLimits,
    /// Memory that large bodies of requests take together \[bytes\], of which one owner may have half.
    pub body_bytes: usize,
    /// Expansions and plans of sweeps.
    pub expansions: ExpansionLimits,
    /// Large answers (tables, pictures, views of histories) that are computed at once.
    pub large_answers: usize,
    /// Bytes of memory that large answers take together. Those that take a quarter of it at most have half of it besides, for
    /// themselves, and so have files that are sent as they are stored.
    pub large_answer_bytes: usize,
    /// Requests for them that may wait; those beyond are told to come back.
    pub large_answers_waiting: usize,
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
            large_answer_allowance: Duration::from_secs(30),
        }
    }
}

/// State shared by the handlers.
#[derive(Clone)]
pub(crate) struct App {
    pub(crate) store: Store,
    pub(crate) config: Arc<Config>,
    /// Turns true when the service is asked to stop; long polls and event streams end on it.
    pub(crate) stopping: watch::Receiver<bool>,
    pub(crate) limiter: Arc<RequestLimiter>,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) readiness: Arc<Readiness>,
    /// Places for event streams.
    pub(crate) streams: Arc<Shares>,
    /// Places for long polls.
    pub(crate) polls: Arc<Shares>,
    /// Addresses that send tokens which are not valid.
    pub(crate) strangers: Arc<Strangers>,
    pub(crate) columns: Arc<KnownColumns>,
    pictures: Arc<Pictures>,
    /// Memory for views of results, which read and write out tables \[KiB\].
    views: Arc<Lane>,
    /// The same for views that take little: they do not wait for those that take much.
    small_views: Arc<Lane>,
    /// Memory for files that are sent as they are stored \[KiB\].
    files: Arc<Lane>,
    /// Places for expanding and planning sweeps, which searches an equilibrium, and for `rk4` estimates how long a step may be.
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
        let strangers = Strangers::new(metrics.refused_tokens.clone());
        App {
            store,
            limiter: Arc::new(RequestLimiter::new(&config.owner_limits)),
            metrics: Arc::new(metrics),
            readiness: Arc::default(),
            streams: Shares::new("event streams", HELD_ANSWERS, LIMITS.held_answers_per_owner),
            polls: Shares::new("long polls", HELD_ANSWERS, LIMITS.held_answers_per_owner),
            strangers: Arc::new(strangers),
            columns: Arc::default(),
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

    /// Takes the memory for a view of a result, and what its body takes on its way.
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

    /// Use of all that requests wait for, by name.
    pub(crate) fn lanes(&self) -> [(&'static str, Occupancy); 5] {
        [
            ("views", self.views.measure(KIB)),
            ("small_views", self.small_views.measure(KIB)),
            ("files", self.files.measure(KIB)),
            ("expansions", self.expansions.measure()),
            ("bodies", self.bodies.measure()),
        ]
    }

    /// Answers with what `prepare` makes in a place of the memory that it needs; a picture is kept under `key`, by which it is the same.
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

    /// Takes the memory for a file that is sent as it is stored.
    pub(crate) async fn file(&self) -> Result<(impl Send + 'static, Allowance)> {
        Ok(self.files.enter(kibibytes(MEMORY_OF_FILE)).await?.into_parts())
    }
}

const KIB: usize = 1 << 10;

fn kibibytes(bytes: u64) -> usize {
    usize::try_from(bytes).unwrap_or(usize::MAX).div_ceil(KIB)
}
