//! Format of the files, as written and as read.

/// Rows of a row group at most.
pub(super) const ROW_GROUP: usize = 10_000;

/// Prefix of the metadata keys that hold units.
pub(super) const UNIT_PREFIX: &str = "unit.";
