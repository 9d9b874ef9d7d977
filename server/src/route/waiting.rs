//! Reason why queued points wait: no worker of their physics version.

use drillsweep_api::{Sweep, SweepState, WaitingFor};

use crate::answer::error::Result;
use crate::app::App;
use crate::route::status::WORKER_SILENCE;

/// Sets `waiting_for` of sweeps whose queued points have no worker of their physics version.
pub(crate) async fn note_waiting(app: &App, sweeps: &mut [Sweep]) -> Result<()> {
    let queued: Vec<&str> =
        sweeps.iter().filter(|sweep| has_queued(sweep)).map(|sweep| sweep.id.as_str()).collect();
    if queued.is_empty() {
        return Ok(());
    }
    let versions = app.store.physics_versions(&queued).await?;
    let workers = app.store.workers(WORKER_SILENCE.as_millis() as i64).await?;
    let mut present: Vec<i64> = workers.iter().map(|worker| worker.physics_version).collect();
    present.sort_unstable();
    present.dedup();
    for sweep in sweeps.iter_mut().filter(|sweep| has_queued(sweep)) {
        let wanted = versions.get(&sweep.id).filter(|version| !present.contains(version));
        sweep.waiting_for = wanted.map(|version| WaitingFor::new(*version, present.clone()));
    }
    Ok(())
}

/// True if points or reference runs would start with a worker.
fn has_queued(sweep: &Sweep) -> bool {
    let verifications = sweep.verification.as_ref().map_or(0, |verification| verification.counts.queued);
    sweep.state == SweepState::Running && sweep.counts.queued + verifications > 0
}
