//! Gyroscopic coupling of the lateral rotations: without it forward and backward whirl have the same frequency.

use super::context::{Decision, EffectContext};
use super::context::{LateralWave, no, yes};
use super::contribution::Term;
use super::element::{ElementInMotion, MotionTerms};

pub(crate) const TERM: Term =
    Term { frequency_change: Some(frequency_change), in_motion: Some(in_motion), ..Term::new(decide) };

fn decide(context: &EffectContext<'_>) -> Decision {
    if context.turns() { yes("the string turns") } else { no("the string does not turn") }
}

/// To first order the rotary moments 2 rho I W change w by rho I W k^2 / (m w), and the wave turns with the string: w = W.
fn frequency_change(wave: &LateralWave) -> f64 {
    wave.density * wave.beam.second_moment * wave.wave_number.powi(2) / wave.mass
}

fn in_motion(element: &ElementInMotion<'_>, terms: &mut MotionTerms) {
    let matrix = element.beam.gyroscopic(element.rotation_speed);
    // Skew, so that it does no work.
    terms.add_damping(None, element.chord.matrix_to_nodes(&matrix));
}
