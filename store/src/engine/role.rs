//! Role of the process that opens a database.

/// Kind of process that opens the store; it decides how durable a commit is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Answers to clients must survive a power cut.
    Server,
    /// A lost claim or result is only computed again.
    Worker,
}
