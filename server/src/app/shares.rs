//! Limits on answers that are held open (long polls, event streams), of all owners and of each.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use drillsweep_api::ProblemKind;

use crate::answer::error::{Error, Result};

/// Retry-After of a refused answer.
const ADVICE: Duration = Duration::from_secs(5);

/// Places for answers that are held open.
pub(crate) struct Shares {
    /// Plural of an answer, for messages.
    answers: &'static str,
    all: usize,
    of_owner: usize,
    open: Mutex<HashMap<String, usize>>,
}

/// A place, until it is dropped.
pub(crate) struct Share {
    shares: Arc<Shares>,
    owner: String,
}

impl Shares {
    pub(crate) fn new(answers: &'static str, all: usize, of_owner: usize) -> Arc<Self> {
        Arc::new(Self { answers, all, of_owner, open: Mutex::default() })
    }

    /// Takes a place. Local callers without a token have the name "", and no limit of their own.
    ///
    /// # Errors
    /// The owner (429), or all owners together (503), are at the limit.
    pub(crate) fn take(self: &Arc<Self>, owner: &str) -> Result<Share> {
        let mut open = self.open();
        if open.values().sum::<usize>() >= self.all {
            let reason = format!("all {} {} are in use", self.all, self.answers);
            return Err(Error::unavailable_for(&reason, ADVICE));
        }
        let own = open.get(owner).copied().unwrap_or_default();
        if own >= self.of_owner && !owner.is_empty() {
            let detail = format!("{owner} has {own} {} open, as many as an owner may have", self.answers);
            return Err(Error::temporary(ProblemKind::TooManyRequests, detail, ADVICE));
        }
        open.insert(owner.to_owned(), own + 1);
        Ok(Share { shares: self.clone(), owner: owner.to_owned() })
    }

    /// The number of open answers.
    pub(crate) fn number(&self) -> usize {
        self.open().values().sum()
    }

    fn open(&self) -> MutexGuard<'_, HashMap<String, usize>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        let mut open = self.shares.open();
        if let Some(own) = open.get_mut(&self.owner) {
            *own -= 1;
            if *own == 0 {
                open.remove(&self.owner);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_owner_has_a_part_of_the_places() {
        let status = |result: Result<Share>| result.err().map_or(200, |error| error.into_problem().status);
        let shares = Shares::new("long polls", 5, 2);
        let mut own: Vec<_> = (0..2).filter_map(|_| shares.take("a").ok()).collect();
        assert_eq!((own.len(), status(shares.take("a")), status(shares.take("b"))), (2, 429, 200));
        let local: Vec<_> = (0..3).filter_map(|_| shares.take("").ok()).collect();
        assert_eq!((local.len(), status(shares.take("b")), shares.number()), (3, 503, 5));
        own.pop();
        assert_eq!((status(shares.take("a")), shares.number()), (200, 4));
        drop((own, local));
        assert!(shares.open().is_empty());
    }
}
