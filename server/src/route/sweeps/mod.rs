//! Sweeps: a file for each kind of request.

pub(crate) mod append;
pub(crate) mod change;
mod expand;
pub(crate) mod list;
pub(crate) mod show;
pub(crate) mod submit;
pub(crate) mod table;

use std::time::Duration;

use drillsweep_api::Sweep;

use crate::answer::error::Result;
use crate::answer::records;
use crate::app::App;
use crate::route::verification::Verified;
use crate::route::waiting::note_waiting;

/// How often a long poll looks for progress within points; workers report it every 20 s.
pub(crate) const PROGRESS_INTERVAL: Duration = Duration::from_secs(2);

/// Requests by which points were added that an answer has: who adds them one by one has thousands, and is answered every time.
const APPENDED_SHOWN: i64 = 100;

/// The sweep with its counts. What verifying its points has shown is left out: that takes their results to tell, too much for each
/// look at a sweep that is followed.
pub(crate) async fn load(app: &App, id: &str) -> Result<Sweep> {
    load_with(app, id, APPENDED_SHOWN).await
}

/// The sweep with what verifying its points has shown.
async fn load_findings(app: &App, id: &str) -> Result<Sweep> {
    with_findings(app, load(app, id).await?).await
}

/// The sweep with all that was ever asked for, and all that it has shown.
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
