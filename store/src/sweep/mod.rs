//! Sweeps with their points: submission, changes, events, failures and verification.

pub(crate) mod change;
pub(crate) mod event;
pub(crate) mod failure;
pub(crate) mod point;
pub(crate) mod record;
pub(crate) mod submit;
pub(crate) mod verification;
