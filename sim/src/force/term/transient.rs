//! The run in time: without it a run ends after its equilibrium and hydraulic profile.

use super::context::{Decision, EffectContext};
use super::context::{no, yes};
use super::contribution::Term;

pub(crate) const TERM: Term = Term::new(decide);

fn decide(context: &EffectContext<'_>) -> Decision {
    let recording = &context.scenario.recording;
    let in_time = !recording.nodes.is_empty()
        || recording.spectrum_windows.as_ref().is_some_and(|windows| !windows.is_empty())
        || recording.orbit_window.is_some()
        || recording.snapshots.is_some()
        || context.scenario.cost_study.is_some();
    if in_time {
        yes("histories are requested")
    } else {
        no("no node is recorded and no window or snapshot requested: only statics and hydraulics")
    }
}
