//! Work items: their states, the queue, leases, and reservations of the blobs of their results.

pub(crate) mod lease;
pub(crate) mod machine;
pub(crate) mod order;
pub(crate) mod queue;
pub(crate) mod reservation;
pub(crate) mod scenario;
pub(crate) mod state;
pub(crate) mod worker;
