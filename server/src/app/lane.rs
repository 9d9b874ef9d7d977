//! Admission control for large answers: weighted semaphores of memory, with a bounded queue.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use axum::response::Response;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, oneshot};
use tokio::time::timeout;

use crate::answer::blocking::{beside, blocking};
use crate::answer::body;
use crate::answer::chunk::Allowance;
use crate::answer::error::{Error, Result};
use crate::answer::format::Answer;
use crate::app::metrics::Occupancy;

/// Longest wait of a request for its place.
const PATIENCE: Duration = Duration::from_secs(30);

/// Retry-After of a refused request.
const ADVICE: Duration = Duration::from_secs(5);

/// A weighted semaphore for one kind of work.
pub(crate) struct Lane {
    units: Arc<Semaphore>,
    all: usize,
    waiting: Semaphore,
    all_waiting: usize,
    refused: AtomicU64,
    turns: Arc<Semaphore>,
    allowance: Duration,
}

/// Units of a lane, held until this is dropped.
pub(crate) struct Place {
    permit: OwnedSemaphorePermit,
    turns: Arc<Semaphore>,
    allowance: Duration,
}

impl Lane {
    /// A lane of `units`, with `at_once` threads that compute and at most `waiting` requests in the queue. A client may keep its answer
    /// waiting for `allowance`.
    pub(crate) fn new(units: usize, at_once: usize, waiting: usize, allowance: Duration) -> Self {
        Self {
            units: Arc::new(Semaphore::new(units)),
            all: units,
            waiting: Semaphore::new(waiting),
            all_waiting: waiting,
            refused: AtomicU64::new(0),
            turns: Arc::new(Semaphore::new(at_once.max(1))),
            allowance,
        }
    }

    /// Takes units, or all if there are fewer, if they are free and no request waits for them.
    pub(crate) fn try_enter(&self, units: usize) -> Option<Place> {
        let permit = self.units.clone().try_acquire_many_owned(self.bounded(units)).ok()?;
        Some(self.place(permit))
    }

    /// Takes units, or all if there are fewer, in order of arrival. Call it before loading anything large.
    pub(crate) async fn enter(&self, units: usize) -> Result<Place> {
        if let Some(place) = self.try_enter(units) {
            return Ok(place);
        }
        let too_many = || {
            self.refused.fetch_add(1, Ordering::Relaxed);
            let reason = "more large answers are requested than can be computed at once";
            Error::unavailable_for(reason, ADVICE)
        };
        let _waiting = self.waiting.try_acquire().map_err(|_| too_many())?;
        match timeout(PATIENCE, self.units.clone().acquire_many_owned(self.bounded(units))).await {
            Ok(Ok(permit)) => Ok(self.place(permit)),
            // The semaphore is never closed.
            Ok(Err(_)) | Err(_) => Err(too_many()),
        }
    }

    /// Counts for the metrics; a unit has `bytes`.
    pub(crate) fn measure(&self, bytes: usize) -> Occupancy {
        Occupancy {
            held: (self.all.saturating_sub(self.units.available_permits()) * bytes) as u64,
            waiting: self.all_waiting.saturating_sub(self.waiting.available_permits()) as u64,
            refused: self.refused.load(Ordering::Relaxed),
        }
    }

    fn bounded(&self, units: usize) -> u32 {
        u32::try_from(units.min(self.all).max(1)).unwrap_or(u32::MAX)
    }

    fn place(&self, permit: OwnedSemaphorePermit) -> Place {
        Place { permit, turns: self.turns.clone(), allowance: self.allowance }
    }
}

impl Place {
    /// Runs work on a separate thread and gives the place back.
    pub(crate) async fn run<T: Send + 'static>(
        self,
        work: impl FnOnce() -> Result<T> + Send + 'static,
    ) -> Result<T> {
        // The work continues to its end after its client has left, and holds its place until then.
        blocking(move || {
            let _place = self;
            work()
        })
        .await
    }

    /// Makes an answer on a separate thread in its turn, and gives the place back.
    pub(crate) async fn make(
        self,
        prepare: impl FnOnce() -> Result<Answer> + Send + 'static,
    ) -> Result<Answer> {
        // The semaphore is never closed.
        let turn = self.turns.clone().acquire_owned().await.map_err(|error| Error::internal(&error))?;
        let (sender, receiver) = oneshot::channel();
        beside(move || {
            let _held = (self, turn);
            // An error means that the client has left.
            let _ = sender.send(prepare());
        })?;
        receiver.await.map_err(|_| Error::internal("the thread that makes an answer has ended"))?
    }

    /// Writes an answer on a separate thread while it is sent, and gives the place back at its end.
    pub(crate) async fn answer(
        self,
        prepare: impl FnOnce() -> Result<Answer> + Send + 'static,
    ) -> Result<Response> {
        body::send(self.turns, Allowance::new(self.allowance), self.permit, prepare).await
    }

    /// Guard that holds the place, and allowance of its client, for a body that is written otherwise.
    pub(crate) fn into_parts(self) -> (impl Send + 'static, Allowance) {
        (self.permit, Allowance::new(self.allowance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALLOWANCE: Duration = Duration::from_secs(10);

    #[tokio::test]
    async fn work_beyond_the_units_waits_and_beyond_the_queue_is_refused() {
        let lane = Arc::new(Lane::new(1, 1, 1, ALLOWANCE));
        let first = lane.enter(1).await.map_err(Error::into_problem).expect("a place is free");
        let second = tokio::spawn({
            let lane = lane.clone();
            async move { lane.enter(1).await.map(drop).is_ok() }
        });
        while lane.waiting.available_permits() > 0 {
            tokio::task::yield_now().await;
        }
        let problem = lane.enter(1).await.err().expect("one waits already").into_problem();
        assert_eq!(problem.status, 503);
        let units = lane.units.clone();
        let done = first.run(move || Ok(units.available_permits())).await;
        assert_eq!(done.ok(), Some(0), "the place is taken while the work runs");
        assert!(second.await.expect("it ends"), "who waits is next");
    }

    #[tokio::test]
    async fn work_takes_its_units_and_at_most_all() {
        let lane = Lane::new(10, 1, 0, ALLOWANCE);
        let small = lane.enter(3).await.map_err(Error::into_problem).expect("there is room");
        let other = lane.enter(7).await.map_err(Error::into_problem).expect("there is just room");
        assert!(lane.enter(1).await.is_err());
        drop((small, other));
        let all = lane.enter(1_000).await.map_err(Error::into_problem).expect("all of it");
        assert!(lane.enter(1).await.is_err());
        drop(all);
        assert_eq!(lane.units.available_permits(), 10);
    }
}
