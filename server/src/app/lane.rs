//! Work that takes a core and memory for a while: some at once, some more that wait, and those beyond told to come back.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

use crate::answer::blocking::blocking;
use crate::answer::error::{Error, Result};

/// How long a request waits for its turn.
const PATIENCE: Duration = Duration::from_secs(30);

/// Places for one kind of work. Requests that need none are not held up by those that do.
pub(crate) struct Lane {
    places: Arc<Semaphore>,
    waiting: Semaphore,
}

/// A place, until it is dropped.
pub(crate) struct Place {
    _permit: OwnedSemaphorePermit,
}

impl Lane {
    /// A lane for so much work at once, and so many requests that wait.
    pub(crate) fn new(at_once: usize, waiting: usize) -> Self {
        Self { places: Arc::new(Semaphore::new(at_once)), waiting: Semaphore::new(waiting) }
    }

    /// Takes a place, in the order of arrival. To be taken before anything large is loaded.
    pub(crate) async fn enter(&self) -> Result<Place> {
        if let Ok(place) = self.places.clone().try_acquire_owned() {
            return Ok(Place { _permit: place });
        }
        let too_many = || Error::unavailable("more large answers are asked for than can be computed at once");
        let _waiting = self.waiting.try_acquire().map_err(|_| too_many())?;
        match timeout(PATIENCE, self.places.clone().acquire_owned()).await {
            Ok(Ok(place)) => Ok(Place { _permit: place }),
            // The semaphore is never closed.
            Ok(Err(_)) | Err(_) => Err(too_many()),
        }
    }
}

impl Place {
    /// Runs the work on a thread of its own and gives the place back.
    pub(crate) async fn run<T: Send + 'static>(
        self,
        work: impl FnOnce() -> Result<T> + Send + 'static,
    ) -> Result<T> {
        // Also where nobody waits for the answer any more: the work goes on to its end, and has its place until then.
        blocking(move || {
            let _place = self;
            work()
        })
        .await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn work_beyond_the_places_waits_and_what_is_beyond_that_is_refused() {
        let lane = Arc::new(Lane::new(1, 1));
        let first = lane.enter().await.map_err(Error::into_problem).expect("a place is free");
        let second = tokio::spawn({
            let lane = lane.clone();
            async move { lane.enter().await.map(drop).is_ok() }
        });
        while lane.waiting.available_permits() > 0 {
            tokio::task::yield_now().await;
        }
        let problem = lane.enter().await.err().expect("one waits already").into_problem();
        assert_eq!(problem.status, 503);
        let places = lane.places.clone();
        let done = first.run(move || Ok(places.available_permits())).await;
        assert_eq!(done.ok(), Some(0), "the place is taken while the work runs");
        assert!(second.await.expect("it ends"), "who waits is next");
    }
}
