//! Eviction of answers whose clients take them slowly, while others have waited long for the memory that they hold.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two evictions: the memory of one answer may be enough.
const BETWEEN_EVICTIONS: Duration = Duration::from_secs(1);

/// Whether an answer is evicted for others that have waited long: one that has held its memory for as long, and most of that time only because
/// its client takes it slowly. Otherwise a few slow clients would hold all memory for hours.
pub(crate) struct Eviction {
    queue: Arc<Queue>,
    since: Instant,
    waited_for_client: Duration,
}

impl Eviction {
    /// Of an answer that holds its memory from now on, for those in the queue.
    pub(crate) fn of(queue: &Arc<Queue>) -> Self {
        Self { queue: queue.clone(), since: Instant::now(), waited_for_client: Duration::ZERO }
    }

    /// Notes that its client has kept it waiting for so long.
    pub(crate) fn note(&mut self, waited: Duration) {
        self.waited_for_client += waited;
    }

    /// Whether the answer is to end now, where its client has kept it waiting for so long besides. One that is told so must end.
    pub(crate) fn is_due(&self, waiting: Duration) -> bool {
        let held = self.since.elapsed();
        let is_slow = held >= self.queue.grace && 2 * (self.waited_for_client + waiting) > held;
        let is_due = is_slow && self.queue.has_waited_long() && self.queue.may_evict();
        if is_due {
            tracing::warn!(
                seconds = held.as_secs(),
                "an answer is broken off: its client takes it slowly, and others have waited long for the memory that it holds"
            );
        }
        is_due
    }
}

/// Requests that wait for a place, in the order of arrival.
pub(crate) struct Queue {
    /// How long somebody waits before others are evicted for them.
    grace: Duration,
    waiting: Mutex<BTreeMap<u64, Instant>>,
    arrivals: AtomicU64,
    evicted: Mutex<Option<Instant>>,
}

/// Somebody in the queue, until it is dropped.
pub(crate) struct Waiter<'q> {
    queue: &'q Queue,
    number: u64,
}

impl Queue {
    /// A queue in which others are evicted for whoever has waited for `grace`.
    pub(crate) fn new(grace: Duration) -> Arc<Self> {
        Arc::new(Queue {
            grace,
            waiting: Mutex::default(),
            arrivals: AtomicU64::new(0),
            evicted: Mutex::default(),
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

    /// Whether the last eviction is long enough ago.
    fn may_evict(&self) -> bool {
        let mut evicted = self.evicted.lock().unwrap_or_else(PoisonError::into_inner);
        let is_early = evicted.is_some_and(|last| last.elapsed() < BETWEEN_EVICTIONS);
        if !is_early {
            *evicted = Some(Instant::now());
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
    fn slow_answers_are_evicted_one_by_one_and_only_where_somebody_waits() {
        let queue = Queue::new(Duration::ZERO);
        let mut slow = Eviction::of(&queue);
        slow.note(Duration::from_secs(3600));
        let computing = Eviction::of(&queue);
        assert!(!slow.is_due(Duration::ZERO), "nobody waits");
        let waiter = queue.wait();
        assert!(!computing.is_due(Duration::ZERO), "it does not wait for its client");
        assert!(slow.is_due(Duration::ZERO));
        assert!(!slow.is_due(Duration::ZERO), "the memory of one may be enough");
        drop(waiter);
        assert!(!queue.has_waited_long());

        let patient = Queue::new(Duration::from_secs(3600));
        let mut slow = Eviction::of(&patient);
        slow.note(Duration::from_secs(3600));
        let _waiter = patient.wait();
        assert!(!slow.is_due(Duration::ZERO), "nobody has waited long");
    }
}
