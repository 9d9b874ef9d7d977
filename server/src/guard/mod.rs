//! Guards of all requests, and checks of submissions.

pub(crate) mod audit;
pub(crate) mod auth;
pub(crate) mod caller;
pub(crate) mod invalid_tokens;
pub(crate) mod measure;
pub(crate) mod middleware;
pub(crate) mod quota;
