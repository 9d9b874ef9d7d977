//! Torsional motion: without it every twist stays at its static value and is not solved for.

use super::contribution::Term;
use super::scene::{Call, Scene};
use super::scene::{no, yes};
use crate::math::dof::THETA_Z;

pub(crate) const TERM: Term = Term { moves: Some(THETA_Z), ..Term::new(called_for) };

fn called_for(scene: &Scene<'_>) -> Call {
    match (scene.active.friction_torque, scene.is_straight()) {
        (true, _) => yes("friction twists the string"),
        (false, false) => yes("the curved hole couples twist with bending"),
        (false, true) => no("a straight string without friction torque has no excitation of torsion"),
    }
}
