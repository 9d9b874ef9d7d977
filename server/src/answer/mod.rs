//! Extraction of requests and creation of answers, for routes and guards.

pub(crate) mod blocking;
pub(crate) mod body;
pub(crate) mod chunk;
pub(crate) mod error;
pub(crate) mod etag;
pub(crate) mod extract;
pub(crate) mod format;
pub(crate) mod json;
pub(crate) mod need;
pub(crate) mod recordings;
pub(crate) mod records;
pub(crate) mod snapshots;
pub(crate) mod stored;
