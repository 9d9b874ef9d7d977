//! Access to the service: tokens, and sessions that they open.

pub(crate) mod session;
pub(crate) mod token;
