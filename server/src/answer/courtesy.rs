//! Answers that give way: whose clients take them slowly, while others have waited long for the memory that they hold.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Of those who give way, one in so long: the memory of one may be enough.
const BETWEEN_TWO_THAT_GIVE_WAY: Duration = Duration::from_secs(1);

/// Whether an answer gives up its place to others that have waited long: one that has had it for as long, and most of that time only because
/// its client takes it slowly. Otherwise a few slow clients would hold all memory for hours.
pub(crate) struct Courtesy {
    queue: Arc<Queue>,
    since: Instant,
    waited_for_client: Duration,
}

impl Courtesy {
    /// Of an answer that has its place from now on, to those who wait.
    pub(crate) fn to(queue: &Arc<Queue>) -> Self {
        Self { queue: queue.clone(), since: Instant::now(), waited_for_client: Duration::ZERO }
    }

    /// Notes that its client has kept it waiting for so long.
    pub(crate) fn note(&mut self, waited: Duration) {
        self.waited_for_client += waited;
    }

    /// Whether it ends now, where its client has kept it waiting for so long besides. Whoever asks and is told so ends.
    pub(crate) fn gives_way(&self, waiting: Duration) -> bool {
        let held = self.since.elapsed();
        let is_slow = held >= self.queue.grace && 2 * (self.waited_for_client + waiting) > held;
        let gives_way = is_slow && self.queue.has_waited_long() && self.queue.takes_one();
        if gives_way {
            tracing::warn!(
                seconds = held.as_secs(),
                "an answer is broken off: its client takes it slowly, and others have waited long for the memory that it holds"
            );
        }
        gives_way
    }
}

/// Who waits for a place, in the order of arrival.
pub(crate) struct Queue {
    /// How long somebody waits before others give way to them.
    grace: Duration,
    waiting: Mutex<BTreeMap<u64, Instant>>,
    arrivals: AtomicU64,
    given_way: Mutex<Option<Instant>>,
}

/// Somebody in the queue, until it is dropped.
pub(crate) struct Waiter<'q> {
    queue: &'q Queue,
    number: u64,
}

impl Queue {
    /// A queue in which whoever has waited for `grace` is given way to.
    pub(crate) fn new(grace: Duration) -> Arc<Self> {
        Arc::new(Queue {
            grace,
            waiting: Mutex::default(),
            arrivals: AtomicU64::new(0),
            given_way: Mutex::default(),
        })
    }

    /// Joins the queue.
    pub(crate) fn wait(&self) -> Waiter<'_> {
        let number = self.arrivals.fetch_add(1, Ordering::Relaxed);
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner).insert(number, Instant::now());
        Waiter { queue: self, number }
    }

    fn has_waited_long(&self) -> bool {
        let waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.first_key_value().is_some_and(|(_, since)| since.elapsed() >= self.grace)
    }

    /// Whether it is the turn of whoever asks to give way.
    fn takes_one(&self) -> bool {
        let mut given_way = self.given_way.lock().unwrap_or_else(PoisonError::into_inner);
        let is_early = given_way.is_some_and(|last| last.elapsed() < BETWEEN_TWO_THAT_GIVE_WAY);
        if !is_early {
            *given_way = Some(Instant::now());
        }
        !is_early
    }
}

impl Drop for Waiter<'_> {
    fn drop(&mut self) {
        self.queue.waiting.lock().unwrap_or_else(PoisonError::into_inner).remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_answers_give_way_one_by_one_and_only_where_somebody_waits() {
        let queue = Queue::new(Duration::ZERO);
        let mut slow = Courtesy::to(&queue);
        slow.note(Duration::from_secs(3600));
        let computing = Courtesy::to(&queue);
        assert!(!slow.gives_way(Duration::ZERO), "nobody waits");
        let waiter = queue.wait();
        assert!(!computing.gives_way(Duration::ZERO), "it does not wait for its client");
        assert!(slow.gives_way(Duration::ZERO));
        assert!(!slow.gives_way(Duration::ZERO), "the memory of one may be enough");
        drop(waiter);
        assert!(!queue.has_waited_long());

        let patient = Queue::new(Duration::from_secs(3600));
        let mut slow = Courtesy::to(&patient);
        slow.note(Duration::from_secs(3600));
        let _waiter = patient.wait();
        assert!(!slow.gives_way(Duration::ZERO), "nobody has waited long");
    }
}
