//! Quota of queued and running points by owner.

use std::time::Duration;

use drillsweep_api::ProblemKind;

use crate::answer::error::{Error, Result};
use crate::app::App;

/// Refuses points beyond an owner's quota. The check and the submission are separate transactions, so that simultaneous submissions may
/// exceed the quota by their size.
pub(crate) async fn check_open_points(app: &App, owner: &str, added: usize) -> Result<()> {
    /// Points take seconds to minutes, so that an earlier retry is useless.
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
