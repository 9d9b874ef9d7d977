//! Interruption of an expansion.

use crate::problem::ProblemDetails;

/// A check between steps of an expansion, which ends it by an error: its client has left, or it has taken too long.
pub type Interruption<'a> = &'a dyn Fn() -> Result<(), Box<ProblemDetails>>;

/// The interruption that never comes.
pub const UNINTERRUPTED: Interruption<'static> = &|| Ok(());
