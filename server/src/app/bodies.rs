//! Memory for the bodies of requests, held from their first byte until the work on them has ended.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::app::metrics::Occupancy;

/// Bytes of a body that are not counted, since those of all connections take little.
pub(crate) const SMALL: usize = 16 << 10;

/// Memory for bodies.
pub(crate) struct Bodies {
    /// All memory, and the share of one owner \[bytes\].
    all: usize,
    of_owner: usize,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    taken: usize,
    by_owner: HashMap<String, usize>,
    refused: u64,
}

/// Memory of one body, until it is dropped.
pub(crate) struct BodyMemory {
    bodies: Arc<Bodies>,
    owner: String,
    bytes: usize,
}

impl Bodies {
    /// Memory of `all` bytes, of which one owner may have half.
    pub(crate) fn new(all: usize) -> Arc<Self> {
        Arc::new(Self { all, of_owner: all / 2, state: Mutex::default() })
    }

    /// Memory of a body of this owner, of no bytes yet.
    pub(crate) fn begin(self: &Arc<Self>, owner: &str) -> BodyMemory {
        BodyMemory { bodies: self.clone(), owner: owner.to_owned(), bytes: 0 }
    }

    /// Counts for the metrics.
    pub(crate) fn measure(&self) -> Occupancy {
        let state = self.state();
        Occupancy { held: state.taken as u64, waiting: 0, refused: state.refused }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl BodyMemory {
    /// Takes memory up to `bytes` for the body; false if so much is not free.
    pub(crate) fn grow(&mut self, bytes: usize) -> bool {
        let Some(more) = bytes.checked_sub(SMALL.max(self.bytes)) else { return true };
        let mut state = self.bodies.state();
        let own = state.by_owner.get(&self.owner).copied().unwrap_or_default();
        if state.taken + more > self.bodies.all || own + more > self.bodies.of_owner {
            state.refused += 1;
            return false;
        }
        state.taken += more;
        state.by_owner.insert(self.owner.clone(), own + more);
        self.bytes = self.bytes.max(SMALL) + more;
        true
    }
}

impl Drop for BodyMemory {
    fn drop(&mut self) {
        let Some(taken) = self.bytes.checked_sub(SMALL).filter(|taken| *taken > 0) else { return };
        let mut state = self.bodies.state();
        state.taken -= taken;
        if let Some(own) = state.by_owner.get_mut(&self.owner) {
            *own -= taken;
            if *own == 0 {
                state.by_owner.remove(&self.owner);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_take_memory_as_they_grow_and_an_owner_half_of_it() {
        const KIB: usize = 1 << 10;
        let bodies = Bodies::new(200 * KIB);
        let mut first = bodies.begin("a");
        assert!(first.grow(10 * KIB) && first.grow(16 * KIB));
        assert_eq!(bodies.measure().held, 0);
        assert!(first.grow(50 * KIB) && first.grow(116 * KIB) && first.grow(20 * KIB));
        assert_eq!(bodies.measure().held as usize, 100 * KIB);
        let mut second = bodies.begin("a");
        assert!(second.grow(16 * KIB) && !second.grow(17 * KIB));
        let mut other = bodies.begin("b");
        assert!(other.grow(116 * KIB) && !bodies.begin("c").grow(17 * KIB));
        drop(first);
        assert!(second.grow(17 * KIB));
        drop((second, other));
        assert_eq!(bodies.measure(), Occupancy { held: 0, waiting: 0, refused: 2 });
        assert!(bodies.state().by_owner.is_empty());
    }
}
