//! How fast an owner may ask, and how much they may have in the queue.

use std::num::NonZeroU32;
use std::time::Duration;

use drillsweep_api::{LIMITS, ProblemKind};
use governor::clock::{Clock, DefaultClock};
use governor::{DefaultKeyedRateLimiter, Quota, RateLimiter};

use crate::app::App;
use crate::error::{Error, Result};

/// What one owner may ask of the service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OwnerLimits {
    /// Requests a second, over longer times.
    pub requests_per_second: NonZeroU32,
    /// Requests at once after a rest.
    pub request_burst: NonZeroU32,
    /// Points that wait or run.
    pub open_points: u64,
}

impl Default for OwnerLimits {
    fn default() -> Self {
        const RATE: NonZeroU32 = NonZeroU32::new(LIMITS.requests_per_second).unwrap();
        const BURST: NonZeroU32 = NonZeroU32::new(LIMITS.request_burst).unwrap();
        OwnerLimits {
            requests_per_second: RATE,
            request_burst: BURST,
            open_points: LIMITS.open_points_per_owner,
        }
    }
}

/// Counts the requests of each owner.
pub(crate) struct RequestLimiter {
    limiter: DefaultKeyedRateLimiter<String>,
    clock: DefaultClock,
}

impl RequestLimiter {
    pub(crate) fn new(limits: &OwnerLimits) -> Self {
        let quota = Quota::per_second(limits.requests_per_second).allow_burst(limits.request_burst);
        RequestLimiter { limiter: RateLimiter::keyed(quota), clock: DefaultClock::default() }
    }

    /// Takes a request from an owner's budget.
    pub(crate) fn admit(&self, owner: &str) -> Result<()> {
        self.limiter.check_key(&owner.to_owned()).map_err(|not_until| {
            let wait = not_until.wait_time_from(self.clock.now());
            Error::too_many(ProblemKind::TooManyRequests, "too many requests at once", wait)
        })
    }
}

/// Refuses points that would make an owner's part of the queue longer than allowed. The check is not one transaction
/// with the submission: submissions at the same instant may exceed it by their own size.
pub(crate) async fn check_open_points(app: &App, owner: &str, added: usize) -> Result<()> {
    /// Points take seconds to minutes: sooner there is no use in trying again.
    const WAIT: Duration = Duration::from_secs(60);
    let limit = app.config.owner_limits.open_points;
    let open = app.store.open_work(owner).await?;
    if open + added as u64 <= limit {
        return Ok(());
    }
    let detail = format!(
        "{owner} has {open} points that wait or run and may have {limit}; {added} more have no room until some are done"
    );
    Err(Error::too_many(ProblemKind::QuotaExceeded, detail, WAIT))
}
