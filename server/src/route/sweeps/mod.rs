//! Sweeps: a file for each kind of request.

pub(crate) mod append;
pub(crate) mod change;
mod expand;
pub(crate) mod list;
pub(crate) mod show;
pub(crate) mod submit;
pub(crate) mod table;
pub(crate) mod window;

use std::time::Duration;

use drillsweep_api::Sweep;

use crate::answer::error::Result;
use crate::answer::records;
use crate::app::App;
use crate::route::verification::Verified;
use crate::route::waiting::note_waiting;

/// Interval at which long polls and event streams look for progress within points, which workers report every 20 s.
pub(crate) const PROGRESS_INTERVAL: Duration = Duration::from_secs(2);

/// Largest number of requests for additional points in an answer: clients that add points one by one have thousands.
const APPENDED_SHOWN: i64 = 100;

/// A sweep with its counts, without findings of its verification: they need the results of its points, too much for each step of a long
/// poll.
pub(crate) async fn load(app: &App, id: &str) -> Result<Sweep> {
    load_with(app, id, APPENDED_SHOWN).await
}

/// A sweep with findings of its verification.
async fn load_findings(app: &App, id: &str) -> Result<Sweep> {
    with_findings(app, load(app, id).await?).await
}

/// A sweep with all its requests, and findings of its verification.
pub(crate) async fn load_whole(app: &App, id: &str) -> Result<Sweep> {
    with_findings(app, load_with(app, id, i64::MAX).await?).await
}

async fn load_with(app: &App, id: &str, appended: i64) -> Result<Sweep> {
    let Some(record) = app.store.sweep(id).await? else { return Err(records::no_such_sweep(id)) };
    let mut sweep = records::sweep_with_requests(&record, &app.store.appended_requests(id, appended).await?)?;
    note_waiting(app, std::slice::from_mut(&mut sweep)).await?;
    Ok(sweep)
}

async fn with_findings(app: &App, mut sweep: Sweep) -> Result<Sweep> {
    if let Some(verification) = &mut sweep.verification {
        let findings = Verified::load(&app.store, &sweep.id).await?.findings;
        verification.worst = findings.worst_orbit_size();
        verification.warnings = findings.warnings;
    }
    Ok(sweep)
}
