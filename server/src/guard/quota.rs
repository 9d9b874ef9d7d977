//! How much an owner may have in the queue.

use std::time::Duration;

use drillsweep_api::ProblemKind;

use crate::answer::error::{Error, Result};
use crate::app::App;

/// Refuses points that would make an owner's part of the queue longer than allowed. The check is not one transaction
/// with the submission: submissions at the same instant may exceed it by their own size.
pub(crate) async fn check_open_points(app: &App, owner: &str, added: usize) -> Result<()> {
    /// Points take seconds to minutes: sooner there is no use in trying again.
    const WAIT: Duration = Duration::from_secs(60);
    let limit = app.config.owner_limits.open_points;
    let open = app.store.open_work(owner).await?;
    if open + added as u64 <= limit {
        return Ok(());
    }
    let detail =
        format!("{owner} has {open} points queued or running; {added} more would exceed the {limit} allowed");
    Err(Error::temporary(ProblemKind::QuotaExceeded, detail, WAIT))
}
