//! Coriolis terms of both flows: without them a flow does no work on a travelling bend.

use super::account::Account;
use super::context::{LateralWave, has_flow};
use super::contribution::Term;
use super::element::{ElementInMotion, MotionTerms};

pub(crate) const TERM: Term =
    Term { frequency_change: Some(frequency_change), in_motion: Some(in_motion), ..Term::new(has_flow) };

/// Work done by the flows: by the Coriolis terms, whose symmetric part is at changes of the section and at the end, and by the follower
/// forces in the stiffness, which are those of the [flow](super::flow_stiffness) at its end and of the
/// [torque](super::torque_stiffening).
pub(crate) const WORK: Account =
    Account::given("work_flow_and_torque", |booked| booked.matrices + booked.follower);

/// To first order the Coriolis term c changes w by c k / (2 m w).
fn frequency_change(wave: &LateralWave) -> f64 {
    wave.flow.map_or(f64::INFINITY, |flow| {
        flow.coriolis.abs() * wave.wave_number / (2.0 * wave.mass * wave.frequency)
    })
}

fn in_motion(element: &ElementInMotion<'_>, terms: &mut MotionTerms) {
    let Some(momentum) = element.momentum else { return };
    let matrix = element.chord.matrix_to_nodes(&element.beam.coriolis()) * momentum.coriolis;
    terms.add_damping(Some(&WORK), matrix);
}
