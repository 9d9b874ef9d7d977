//! Admission control for expansions and plans of sweeps: places shared fairly between owners, each with memory, a limit on processor time,
//! and an end when its client leaves or the service stops.

use std::collections::{HashMap, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use drillsweep_api::{ProblemDetails, ProblemKind};
use rustix::time::{ClockId, clock_gettime};
use tokio::sync::{oneshot, watch};
use tokio::time::timeout;

use crate::answer::blocking::blocking;
use crate::answer::error::{Error, Result};
use crate::app::metrics::Occupancy;

/// Longest wait for a place.
const PATIENCE: Duration = Duration::from_secs(30);

/// Wait after which the oldest request is next, even if others would fit.
const LONG: Duration = Duration::from_secs(5);

/// Retry-After of a refused request.
const ADVICE: Duration = Duration::from_secs(2);

/// Sizes of the places for expansions.
#[derive(Debug, Clone)]
pub struct ExpansionLimits {
    /// Expansions that compute at once; if there are two or more, one owner has at most half.
    pub at_once: usize,
    /// Memory of all expansions together \[bytes\].
    pub bytes: usize,
    /// Requests that wait, a quarter of them of one owner; further ones are refused.
    pub waiting: usize,
    /// Processor time of one expansion, to which that of its points is added.
    pub deadline: Duration,
}

/// Places for expansions.
pub(crate) struct Expansions {
    limits: ExpansionLimits,
    stopping: watch::Receiver<bool>,
    state: Mutex<State>,
}

struct State {
    /// Free memory \[bytes\].
    free: usize,
    computing: usize,
    /// Owners with a computing or waiting request.
    owners: HashMap<String, Owner>,
    waiting: VecDeque<Waiter>,
    refused: u64,
    /// Time of the last admission.
    admitted: Instant,
}

#[derive(Default)]
struct Owner {
    computing: usize,
    waiting: usize,
}

struct Waiter {
    owner: String,
    bytes: usize,
    since: Instant,
    wake: oneshot::Sender<Place>,
}

/// A turn to compute, with memory.
pub(crate) struct Place {
    turn: Turn,
    memory: Memory,
}

struct Turn {
    expansions: Arc<Expansions>,
    owner: String,
}

/// Memory of an expansion, until it is dropped.
pub(crate) struct Memory {
    expansions: Arc<Expansions>,
    bytes: usize,
}

impl Expansions {
    pub(crate) fn new(limits: ExpansionLimits, stopping: watch::Receiver<bool>) -> Arc<Self> {
        let state = State {
            free: limits.bytes,
            computing: 0,
            owners: HashMap::new(),
            waiting: VecDeque::new(),
            refused: 0,
            admitted: Instant::now(),
        };
        Arc::new(Self { limits, stopping, state: Mutex::new(state) })
    }

    /// Takes a place of `bytes`, or of all memory if there is less, in order of arrival among the owners with the fewest computing
    /// requests.
    ///
    /// # Errors
    /// Too many requests wait, of all owners (503) or of this one (429), or no place has become free in time (503).
    pub(crate) async fn enter(self: &Arc<Self>, owner: &str, bytes: usize) -> Result<Place> {
        let (wake, woken) = oneshot::channel();
        self.queue(owner, bytes, wake)?;
        self.admit();
        match timeout(PATIENCE, woken).await {
            Ok(Ok(place)) => Ok(place),
            Ok(Err(_)) | Err(_) => {
                self.state().refused += 1;
                Err(Error::unavailable_for("no expansion of a sweep has ended in time", ADVICE))
            }
        }
    }

    fn queue(&self, owner: &str, bytes: usize, wake: oneshot::Sender<Place>) -> Result<()> {
        let mut state = self.state();
        state.forget_gone();
        let of_owner = state.owners.get(owner).map_or(0, |owner| owner.waiting);
        if state.waiting.len() >= self.limits.waiting {
            state.refused += 1;
            return Err(Error::unavailable_for("too many expansions of sweeps wait", ADVICE));
        }
        if of_owner >= (self.limits.waiting / 4).max(1) {
            state.refused += 1;
            let detail = format!("{of_owner} submissions and plans of this owner wait already");
            return Err(Error::temporary(ProblemKind::TooManyRequests, detail, ADVICE));
        }
        state.owners.entry(owner.to_owned()).or_default().waiting += 1;
        let bytes = bytes.min(self.limits.bytes);
        state.waiting.push_back(Waiter { owner: owner.to_owned(), bytes, since: Instant::now(), wake });
        Ok(())
    }

    /// Gives free places to waiting requests.
    fn admit(self: &Arc<Self>) {
        loop {
            let next = {
                let mut state = self.state();
                state.forget_gone();
                state.next(&self.limits)
            };
            let Some(Waiter { owner, bytes, wake, .. }) = next else { return };
            let place = Place {
                turn: Turn { expansions: self.clone(), owner },
                memory: Memory { expansions: self.clone(), bytes },
            };
            // If the client has left, its place is dropped, which admits the next.
            let _ = wake.send(place);
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// True if requests wait and none has been admitted for longer than they may wait.
    pub(crate) fn is_stuck(&self) -> bool {
        let mut state = self.state();
        state.forget_gone();
        let waited = state.waiting.front().is_some_and(|oldest| oldest.since.elapsed() > PATIENCE / 2);
        waited && state.admitted.elapsed() > PATIENCE / 2
    }

    /// Counts for the metrics.
    pub(crate) fn measure(&self) -> Occupancy {
        let state = self.state();
        Occupancy {
            held: (self.limits.bytes - state.free) as u64,
            waiting: state.waiting.len() as u64,
            refused: state.refused,
        }
    }
}

impl State {
    /// Drops requests whose clients have left, or whose time is over.
    fn forget_gone(&mut self) {
        let owners = &mut self.owners;
        self.waiting.retain(|waiter| {
            let is_gone = waiter.wake.is_closed();
            if is_gone {
                change(owners, &waiter.owner, |owner| owner.waiting -= 1);
            }
            !is_gone
        });
    }

    /// The request that is admitted next, with its place taken.
    fn next(&mut self, limits: &ExpansionLimits) -> Option<Waiter> {
        if self.computing >= limits.at_once {
            return None;
        }
        let most = (limits.at_once / 2).max(1);
        let computing = |waiter: &Waiter| self.owners.get(&waiter.owner).map_or(0, |owner| owner.computing);
        let has_turn = |waiter: &Waiter| computing(waiter) < most;
        let fits = |waiter: &Waiter| waiter.bytes <= self.free;
        let is_due = |waiter: &&Waiter| has_turn(waiter) && waiter.since.elapsed() > LONG;
        let due = self.waiting.iter().find(is_due).map(|due| due.since);
        // Requests without memory hold that of an earlier place, for which the oldest may wait.
        let may_pass = |waiter: &Waiter| due.is_none_or(|due| waiter.since <= due) || waiter.bytes == 0;
        let ready = self.waiting.iter().enumerate();
        let ready = ready.filter(|(_, waiter)| has_turn(waiter) && fits(waiter) && may_pass(waiter));
        let index = ready.min_by_key(|(index, waiter)| (computing(waiter), *index)).map(|(index, _)| index);
        let waiter = self.waiting.remove(index?)?;
        self.free -= waiter.bytes;
        self.computing += 1;
        self.admitted = Instant::now();
        change(&mut self.owners, &waiter.owner, |owner| {
            owner.waiting -= 1;
            owner.computing += 1;
        });
        Some(waiter)
    }
}

/// Changes the counts of an owner, and removes them once they are 0.
fn change(owners: &mut HashMap<String, Owner>, name: &str, change: impl FnOnce(&mut Owner)) {
    if let Some(owner) = owners.get_mut(name) {
        change(owner);
        if owner.computing == 0 && owner.waiting == 0 {
            owners.remove(name);
        }
    }
}

impl Place {
    /// Runs work on a separate thread, which holds the turn until its end, and returns the memory.
    ///
    /// # Errors
    /// Errors of the work.
    pub(crate) async fn run<T: Send + 'static>(
        self,
        work: impl FnOnce(&mut Work) -> Result<T> + Send + 'static,
    ) -> Result<(T, Memory)> {
        let Place { turn, memory } = self;
        let has_left = Arc::new(AtomicBool::new(false));
        let _leaves = Leaves(has_left.clone());
        blocking(move || {
            let mut at_work = Work {
                memory,
                has_left,
                stopping: turn.expansions.stopping.clone(),
                start: thread_time(),
                deadline: turn.expansions.limits.deadline,
            };
            let done = work(&mut at_work)?;
            drop(turn);
            Ok((done, at_work.memory))
        })
        .await
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        {
            let mut state = self.expansions.state();
            state.computing -= 1;
            change(&mut state.owners, &self.owner, |owner| owner.computing -= 1);
        }
        self.expansions.admit();
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        self.expansions.state().free += self.bytes;
        self.expansions.admit();
    }
}

/// Raises the flag when the future that holds it is dropped.
struct Leaves(Arc<AtomicBool>);

impl Drop for Leaves {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Work in a place: its memory, and reasons to end early.
pub(crate) struct Work {
    memory: Memory,
    has_left: Arc<AtomicBool>,
    stopping: watch::Receiver<bool>,
    /// Processor time of the thread when the work began.
    start: Duration,
    deadline: Duration,
}

impl Work {
    /// Takes memory up to `bytes`, if so much is free now; false otherwise.
    pub(crate) fn grow(&mut self, bytes: usize) -> bool {
        let expansions = &self.memory.expansions;
        let bytes = bytes.min(expansions.limits.bytes);
        let Some(more) = bytes.checked_sub(self.memory.bytes) else { return true };
        let mut state = expansions.state();
        let is_free = state.free >= more;
        if is_free {
            state.free -= more;
            drop(state);
            self.memory.bytes = bytes;
        }
        is_free
    }

    /// Adds processor time for work that is known to take more.
    pub(crate) fn allow(&mut self, more: Duration) {
        self.deadline += more;
    }

    /// Ends the work if its client has left, the service stops or its processor time is over.
    ///
    /// # Errors
    /// The problem to answer with.
    pub(crate) fn check(&self) -> Result<(), Box<ProblemDetails>> {
        let end = |kind, detail: String| Err(Box::new(ProblemDetails::new(kind, detail)));
        if self.has_left.load(Ordering::Relaxed) {
            return end(ProblemKind::Unavailable, "the client has left".to_owned());
        }
        if *self.stopping.borrow() {
            return end(ProblemKind::Unavailable, "the service is stopping".to_owned());
        }
        if thread_time().saturating_sub(self.start) > self.deadline {
            let seconds = self.deadline.as_secs_f64();
            let detail = format!(
                "expanding the request takes more than {seconds} s of processor time; submit it in parts, or with a smaller scenario"
            );
            return end(ProblemKind::TooMuchWork, detail);
        }
        Ok(())
    }
}

fn thread_time() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), u32::try_from(time.tv_nsec).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expansions(at_once: usize, bytes: usize, waiting: usize) -> Arc<Expansions> {
        // Without a sender the last value remains.
        let (_, stopping) = watch::channel(false);
        let limits = ExpansionLimits { at_once, bytes, waiting, deadline: Duration::from_millis(20) };
        Expansions::new(limits, stopping)
    }

    fn status<T>(result: Result<T>) -> u16 {
        result.err().map_or(200, |error| error.into_problem().status)
    }

    /// A request that waits until the test has seen it in the queue.
    async fn waiting(
        expansions: &Arc<Expansions>,
        owner: &'static str,
        bytes: usize,
    ) -> tokio::task::JoinHandle<Result<Place>> {
        let before = expansions.measure().waiting;
        let task = tokio::spawn({
            let expansions = expansions.clone();
            async move { expansions.enter(owner, bytes).await }
        });
        while expansions.measure().waiting == before {
            tokio::task::yield_now().await;
        }
        task
    }

    #[tokio::test]
    async fn an_owner_has_half_of_the_turns_and_others_do_not_wait_for_it() {
        let expansions = expansions(2, 100, 40);
        let first = expansions.enter("a", 1).await.map_err(Error::into_problem).expect("a turn");
        let mut own = Vec::new();
        for _ in 0..10 {
            own.push(waiting(&expansions, "a", 1).await);
        }
        // The eleventh is too many for this owner, and not for others.
        assert_eq!(status(expansions.enter("a", 1).await), 429);
        let other = expansions.enter("b", 1).await.map_err(Error::into_problem).expect("a turn");
        drop((first, other));
        for own in own {
            let place = own.await.expect("it ends");
            assert_eq!(status(place), 200);
        }
        assert_eq!(expansions.measure(), Occupancy { held: 0, waiting: 0, refused: 1 });
        assert!(expansions.state().owners.is_empty());
    }

    #[tokio::test]
    async fn memory_is_taken_by_weight_and_kept_until_it_is_dropped() {
        let expansions = expansions(4, 100, 40);
        let place = expansions.enter("a", 30).await.map_err(Error::into_problem).expect("a turn");
        let other = expansions.enter("c", 40).await.map_err(Error::into_problem).expect("a turn");
        let work = |work: &mut Work| Ok([work.grow(61), work.grow(20), work.grow(60), work.grow(201)]);
        let (grown, memory) = place.run(work).await.map_err(Error::into_problem).expect("it ends");
        // At most all memory, which is not free.
        assert_eq!((grown, expansions.measure().held), ([false, true, true, false], 100));
        drop(other);
        let other = waiting(&expansions, "b", 70).await;
        assert_eq!(expansions.measure().waiting, 1);
        drop(memory);
        assert_eq!(status(other.await.expect("it ends")), 200);
    }

    #[tokio::test]
    async fn a_client_that_leaves_ends_its_work_and_its_wait() {
        let expansions = expansions(1, 100, 40);
        let place = expansions.enter("a", 1).await.map_err(Error::into_problem).expect("a turn");
        let (begun, begins) = oneshot::channel();
        let work = tokio::spawn(place.run(move |work| -> Result<()> {
            let _ = begun.send(());
            loop {
                work.check()?;
                std::thread::yield_now();
            }
        }));
        begins.await.expect("it begins");
        let waits = waiting(&expansions, "a", 1).await;
        work.abort();
        assert_eq!(status(waits.await.expect("it ends")), 200, "the turn is free again");
        let first = expansions.enter("a", 1).await.map_err(Error::into_problem).expect("a turn");
        let leaves = waiting(&expansions, "a", 1).await;
        leaves.abort();
        assert!(leaves.await.is_err());
        drop(first);
        assert!(expansions.enter("b", 100).await.is_ok());
    }

    #[tokio::test]
    async fn work_ends_at_its_deadline_of_processor_time() {
        let expansions = expansions(1, 100, 40);
        let place = expansions.enter("a", 1).await.map_err(Error::into_problem).expect("a turn");
        let work = place.run(|work| -> Result<()> {
            loop {
                work.check()?;
            }
        });
        let problem = work.await.err().expect("it is ended").into_problem();
        assert_eq!(
            (problem.status, problem.type_uri.as_str()),
            (422, "urn:drillsweep:problem:too-much-work")
        );
    }
}
