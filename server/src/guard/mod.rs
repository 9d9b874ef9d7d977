//! Guards that every request passes through before its route, and checks that a submission has to pass.

pub(crate) mod audit;
pub(crate) mod auth;
pub(crate) mod caller;
pub(crate) mod measure;
pub(crate) mod middleware;
pub(crate) mod quota;
pub(crate) mod strangers;
