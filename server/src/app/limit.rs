//! Limits of one owner: requests, their rate, and open points.

use std::num::NonZeroU32;

use drillsweep_api::{LIMITS, ProblemKind};
use governor::clock::{Clock, DefaultClock};
use governor::{DefaultKeyedRateLimiter, Quota, RateLimiter};

use crate::answer::error::{Error, Result};

/// Limits of one owner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OwnerLimits {
    /// Requests a second in the long run.
    pub requests_per_second: NonZeroU32,
    /// Requests at once after a pause.
    pub request_burst: NonZeroU32,
    /// Points that are queued or running.
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

/// Rate limiter of requests by owner.
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
            Error::temporary(ProblemKind::TooManyRequests, "too many requests at once", wait)
        })
    }
}
