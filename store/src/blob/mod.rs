//! Blobs: content-addressed objects in a directory or a bucket.

pub(crate) mod backend;
pub(crate) mod certificate;
pub(crate) mod counted;
pub(crate) mod file;
pub(crate) mod hash_tree;
pub(crate) mod location;
pub(crate) mod metrics;
pub(crate) mod object;
pub(crate) mod store;
