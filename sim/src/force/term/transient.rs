//! The run in time: without it a run ends after its equilibrium and hydraulic profile.

use super::contribution::Term;
use super::scene::{Call, Scene};
use super::scene::{no, yes};

pub(crate) const TERM: Term = Term::new(called_for);

fn called_for(scene: &Scene<'_>) -> Call {
    let recording = &scene.scenario.recording;
    let in_time = !recording.nodes.is_empty()
        || recording.spectrum_windows.as_ref().is_some_and(|windows| !windows.is_empty())
        || recording.orbit_window.is_some()
        || recording.snapshots.is_some()
        || scene.scenario.cost_study.is_some();
    if in_time {
        yes("histories are requested")
    } else {
        no("no node is recorded and no window or snapshot requested: only statics and hydraulics")
    }
}
