//! Care of a store as a whole: census, check and repair, garbage collection, health, transfer.

pub(crate) mod census;
pub(crate) mod check;
pub(crate) mod garbage;
pub(crate) mod metrics;
pub(crate) mod probe;
pub(crate) mod repair;
pub(crate) mod transfer;
