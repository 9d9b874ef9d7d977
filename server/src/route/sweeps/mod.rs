//! Sweeps: a file for each kind of request.

pub(crate) mod append;
pub(crate) mod change;
mod expand;
pub(crate) mod list;
mod points;
pub(crate) mod request;
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

/// Longest request in an answer, and most text of requests for additional points in one \[bytes\]: clients that poll a sweep of listed
/// points would receive megabytes each time.
const REQUEST_SHOWN: i64 = 64 << 10;

/// A sweep with its counts, without its requests and without findings of its verification, which need the results of its points: both are
/// too much for each step of a long poll or event of a stream.
pub(crate) async fn state(app: &App, id: &str) -> Result<Sweep> {
    let Some(record) = app.store.sweep(id).await? else { return Err(records::no_such_sweep(id)) };
    let mut sweep = records::sweep(&record)?;
    note_waiting(app, std::slice::from_mut(&mut sweep)).await?;
    Ok(sweep)
}

/// A sweep with its requests, unless they are long.
pub(crate) async fn load(app: &App, id: &str) -> Result<Sweep> {
    with_requests(app, state(app, id).await?, APPENDED_SHOWN, REQUEST_SHOWN).await
}

/// A sweep with findings of its verification.
async fn load_findings(app: &App, id: &str) -> Result<Sweep> {
    with_findings(app, load(app, id).await?).await
}

/// A sweep with all its requests, and findings of its verification.
pub(crate) async fn load_whole(app: &App, id: &str) -> Result<Sweep> {
    let sweep = with_requests(app, state(app, id).await?, i64::MAX, i64::MAX).await?;
    with_findings(app, sweep).await
}

/// A sweep with its request if that has at most `bytes`, and with the latest `appended` requests for additional points of as many bytes.
async fn with_requests(app: &App, sweep: Sweep, appended: i64, bytes: i64) -> Result<Sweep> {
    let id = &sweep.id;
    let is_shown = app.store.request_bytes(id).await?.is_some_and(|length| length <= bytes);
    let request = if is_shown { app.store.request_json(id).await? } else { None };
    let request = request.as_deref().map(records::read).transpose()?;
    let appended = app.store.appended_requests(id, appended, bytes).await?;
    let appended = appended.iter().map(|request| records::read(request)).collect::<Result<_>>()?;
    Ok(Sweep { request, appended, ..sweep })
}

async fn with_findings(app: &App, mut sweep: Sweep) -> Result<Sweep> {
    if let Some(verification) = &mut sweep.verification {
        let findings = Verified::load(&app.store, &sweep.id).await?.findings;
        verification.worst = findings.worst_orbit_size();
        verification.warnings = findings.warnings;
    }
    Ok(sweep)
}
