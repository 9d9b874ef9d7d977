//! Pseudo-transient relaxation: the string creeps from its position to rest, through a viscous medium.
//!
//! `c x' = R(x)` for the lateral displacements, by implicit Euler steps that are each solved in full (Kelley and Keyes 1998). However stiff the wall,
//! a step that is short enough has a solution next to its start, and if the string is stable, it creeps to an equilibrium. Steps become
//! longer as long as they are solved easily.

use super::newton::{self, NewtonOutcome, linearise, tributary_lengths};
use crate::math::dof::{DOFS, U, V};
use crate::math::linalg::Factor;
use crate::solve::model::{Model, NodalVector};

/// Drag c over the step, per length \[N/m2\], of the first step.
const FIRST_DRAG: f64 = 1e6;

/// Drag at which a step is a Newton step without drag: far below the force of a string's weight over its clearance.
const NO_DRAG: f64 = 1.0;

/// Drag at which steps have become so short that the search is given up.
const MOST_DRAG: f64 = 1e14;

/// Factors by which the drag falls after a solved step, and grows after a failed one.
const SLACKEN: f64 = 0.3;
const TIGHTEN: f64 = 8.0;

/// Iterations within which a step has to be solved.
const MOST_ITERATIONS: usize = 12;

/// Iterations up to which a step was solved easily.
const EASY: usize = 6;

/// Last correction at which a step is solved, in the largest displacement (or 1 m, 1 rad).
const SOLVED: f64 = 1e-7;

/// Linearisations after which the search is given up.
const MOST_LINEARISATIONS: usize = 3000;

/// Moves `displacement` to the position of rest under `load`; `None` if the string does not come to rest.
pub(super) fn settle(
    model: &Model,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
) -> Option<NewtonOutcome> {
    let tributary = tributary_lengths(model);
    let mut drag = FIRST_DRAG;
    let mut linearisations = 0;
    while linearisations < MOST_LINEARISATIONS && drag < MOST_DRAG {
        match step(model, load, &tributary, displacement, drag) {
            Some((next, iterations)) => {
                linearisations += iterations;
                *displacement = next;
                if iterations <= EASY {
                    drag *= SLACKEN;
                }
            }
            None => {
                linearisations += MOST_ITERATIONS;
                drag *= TIGHTEN;
            }
        }
        if drag < NO_DRAG {
            let mut at_rest = displacement.clone();
            if let Some(outcome) = newton::finish(model, load, &mut at_rest) {
                *displacement = at_rest;
                return Some(outcome);
            }
            linearisations += newton::LAST_ITERATIONS;
            drag = FIRST_DRAG;
        }
    }
    None
}

/// One implicit step from `start`, and the iterations it took.
fn step(
    model: &Model,
    load: &[[f64; DOFS]],
    tributary: &[f64],
    start: &[[f64; DOFS]],
    drag: f64,
) -> Option<(NodalVector, usize)> {
    let mut next = start.to_vec();
    let mut last = f64::INFINITY;
    for iteration in 1..=MOST_ITERATIONS {
        let (mut correction, mut tangent) = linearise(model, &model.wall, load, &next);
        for (node, length) in tributary.iter().enumerate() {
            for dof in [U, V] {
                correction[node][dof] -= drag * length * (next[node][dof] - start[node][dof]);
                tangent.diagonal[node][(dof, dof)] += drag * length;
            }
        }
        Factor::new(&tangent).ok()?.solve_in_place(&mut correction);
        let mut size: f64 = 0.0;
        for (value, correction) in next.iter_mut().flatten().zip(correction.iter().flatten()) {
            *value += correction;
            size = size.max(correction.abs());
        }
        if !size.is_finite() || (iteration > EASY && size > last) {
            return None;
        }
        let largest = next.iter().flatten().fold(1.0_f64, |most, value| most.max(value.abs()));
        if size <= SOLVED * largest {
            return Some((next, iteration));
        }
        last = size;
    }
    None
}
