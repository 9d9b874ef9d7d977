//! Axial motion: without it every axial displacement stays at its static value and is not solved for.

use super::contribution::Term;
use super::scene::{Call, Scene};
use super::scene::{no, yes};
use crate::math::dof::W;

pub(crate) const TERM: Term = Term { moves: Some(W), ..Term::new(called_for) };

fn called_for(scene: &Scene<'_>) -> Call {
    if scene.is_straight() {
        no("a straight string has no excitation of axial motion")
    } else {
        yes("the curved hole couples axial motion with bending")
    }
}
