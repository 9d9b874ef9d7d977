//! A path of equilibria, followed by its arc length.
//!
//! `R(x, s) = 0`, the balance under a share s of a growing quantity, is a path through x and s. It is followed by its arc length (Riks 1979;
//! Keller 1977), so that it may turn back in s: at such a limit point, the equilibria that began at s = 0 end. Its sense is that of the
//! determinant of its tangent (Allgower and Georg 1990), which holds on at corners of a path that is smooth piece by piece.

use super::newton::{self, NewtonOutcome, tributary_lengths};
use crate::math::dof::{DOFS, U, V};
use crate::math::linalg::{BlockTridiagonal, Factor};
use crate::solve::model::{Model, NodalVector};

/// First step along the path, in shares or radii of the hole, whichever are more.
const FIRST_STEP: f64 = 0.05;

/// Shortest step: the search has lost a path that needs shorter ones.
const SHORTEST_STEP: f64 = 1e-9;

/// Step below which a corner of the path is expected.
const CORNER_STEP: f64 = 1e-5;

/// Distances ahead at which the direction behind a corner is taken, one after the other.
const CORNERS: [f64; 4] = [1e-6, 1e-5, 1e-4, 1e-3];

/// Linearisations after which a path is left.
const MOST_LINEARISATIONS: usize = 12_000;

/// Iterations within which a step has to return to the path.
const MOST_CORRECTIONS: usize = 10;

/// Last correction at which a step has returned, in the largest displacement (or 1 m, 1 rad), and of the share.
const ON_THE_PATH: f64 = 1e-8;

/// Quantity that grows along a path from zero, at s = 0, to its whole, at s = 1.
pub(super) trait Growth {
    /// Unbalanced forces at a point, their tangent, and their derivative by the share; `None` if the point has none.
    fn linearise(&self, at: &Point) -> Option<(NodalVector, BlockTridiagonal, NodalVector)>;

    /// Moves `displacement` from next to the end of the path onto it.
    fn arrive(&self, displacement: &mut NodalVector) -> Option<NewtonOutcome>;
}

/// Follows the path from `displacement`, at s = 0, and moves it to the end of the path, at s = 1; `None` if the path turns back to its
/// beginning, or the search loses the path.
pub(super) fn follow(
    model: &Model,
    growth: &impl Growth,
    displacement: &mut NodalVector,
) -> Option<NewtonOutcome> {
    let start = displacement.clone();
    let path =
        Path { model, growth, tributary: tributary_lengths(model), linearisations: 0, starts_negative: None };
    path.follow(start, displacement)
}

struct Path<'a, G> {
    model: &'a Model,
    growth: &'a G,
    tributary: Vec<f64>,
    linearisations: usize,
    /// Sign of the tangent's determinant at the beginning.
    starts_negative: Option<bool>,
}

/// A point of the path, or a direction along it.
#[derive(Clone)]
pub(super) struct Point {
    pub(super) displacement: NodalVector,
    pub(super) share: f64,
}

impl Point {
    fn plus(&self, factor: f64, other: &Self) -> Self {
        let mut sum = self.clone();
        add(&mut sum.displacement, factor, &other.displacement);
        sum.share += factor * other.share;
        sum
    }
}

impl<G: Growth> Path<'_, G> {
    fn follow(mut self, start: NodalVector, displacement: &mut NodalVector) -> Option<NewtonOutcome> {
        let mut here = Point { displacement: start, share: 0.0 };
        let mut step = FIRST_STEP;
        loop {
            let direction = self.direction(&here)?;
            let (next, corrections) = loop {
                if let Some((next, corrections)) = self.step(&here, &direction, step) {
                    if next.share < 1.0 {
                        break (next, corrections);
                    }
                    let crossing = (1.0 - here.share) / (next.share - here.share);
                    let mut at_load = here.displacement.clone();
                    at_load.iter_mut().flatten().for_each(|value| *value *= 1.0 - crossing);
                    add(&mut at_load, crossing, &next.displacement);
                    self.linearisations += newton::LAST_ITERATIONS;
                    if let Some(outcome) = self.growth.arrive(&mut at_load) {
                        *displacement = at_load;
                        return Some(outcome);
                    }
                }
                step *= 0.5;
                if step < CORNER_STEP
                    && let Some(next) = self.round_corner(&here, &direction)
                {
                    step = CORNER_STEP;
                    break (next, MOST_CORRECTIONS);
                }
                if step < SHORTEST_STEP || self.linearisations > MOST_LINEARISATIONS {
                    return None;
                }
            };
            here = next;
            if here.share < 0.0 || self.linearisations > MOST_LINEARISATIONS {
                return None;
            }
            step *= match corrections {
                ..=3 => 2.0,
                4..=5 => 1.4,
                _ => 1.0,
            };
        }
    }

    /// The direction of the path at a point, of length 1.
    ///
    /// Onwards the share grows while the determinant of the tangent has the sign that it has at the beginning, and falls otherwise: the
    /// determinant of the tangent bordered by the direction keeps its sign along a path, round corners too.
    fn direction(&mut self, here: &Point) -> Option<Point> {
        let (_, factor, slope) = self.linearised(here)?;
        let mut displacement = slope;
        factor.solve_in_place(&mut displacement);
        let size = (self.product(&displacement, &displacement) + 1.0).sqrt();
        let is_negative = factor.has_negative_determinant();
        let is_backward = is_negative != *self.starts_negative.get_or_insert(is_negative);
        let share = if is_backward { -1.0 / size } else { 1.0 / size };
        displacement.iter_mut().flatten().for_each(|value| *value *= share);
        share.is_finite().then_some(Point { displacement, share })
    }

    /// A point of the path about `step` from `here`, in the plane normal to the path there, and the corrections it took.
    fn step(&mut self, here: &Point, direction: &Point, step: f64) -> Option<(Point, usize)> {
        let mut next = here.plus(step, direction);
        let mut last = f64::INFINITY;
        for correction in 1..=MOST_CORRECTIONS {
            let (residual, factor, slope) = self.linearised(&next)?;
            let (mut at_share, mut by_share) = (residual, slope);
            factor.solve_in_place(&mut at_share);
            factor.solve_in_place(&mut by_share);
            let share = -self.product(&direction.displacement, &at_share)
                / (self.product(&direction.displacement, &by_share) + direction.share);
            add(&mut at_share, share, &by_share);
            let size = at_share.iter().flatten().fold(share.abs(), |most, value| most.max(value.abs()));
            // A correction longer than the step itself leads to another path.
            let distance = (self.product(&at_share, &at_share) + share * share).sqrt();
            if !size.is_finite() || size > 2.0 * last || distance > step {
                return None;
            }
            next = next.plus(1.0, &Point { displacement: at_share, share });
            let largest =
                next.displacement.iter().flatten().fold(1.0_f64, |most, value| most.max(value.abs()));
            if size <= ON_THE_PATH * largest {
                return Some((next, correction));
            }
            last = size;
        }
        None
    }

    /// A point behind a corner of the path; `None` if there is no corner.
    ///
    /// The path may turn back sharply where a part of the string meets the wall or leaves it, so that nothing lies ahead. Its direction
    /// behind the corner follows from the tangent ahead.
    fn round_corner(&mut self, here: &Point, direction: &Point) -> Option<Point> {
        CORNERS.iter().find_map(|&reach| {
            let onwards = self.direction(&here.plus(reach, direction))?;
            let (next, _) = self.step(here, &onwards, reach)?;
            (next.share < 1.0).then_some(next)
        })
    }

    /// Unbalanced forces at a point, the factor of their tangent, and their derivative by the share.
    fn linearised(&mut self, at: &Point) -> Option<(NodalVector, Factor, NodalVector)> {
        self.linearisations += 1;
        let (residual, tangent, slope) = self.growth.linearise(at)?;
        Some((residual, Factor::new(&tangent).ok()?, slope))
    }

    /// The product of two lateral displacements, mean along the string, in squares of the hole's radius.
    fn product(&self, a: &[[f64; DOFS]], b: &[[f64; DOFS]]) -> f64 {
        let radius = 0.5 * self.model.scenario.well.hole_diameter;
        let nodes = a.iter().zip(b).zip(&self.tributary);
        let sum: f64 = nodes.map(|((a, b), length)| length * (a[U] * b[U] + a[V] * b[V])).sum();
        sum / (self.tributary.iter().sum::<f64>() * radius * radius)
    }
}

/// Adds a multiple of a vector to another.
pub(super) fn add(target: &mut [[f64; DOFS]], factor: f64, other: &[[f64; DOFS]]) {
    for (target, other) in target.iter_mut().flatten().zip(other.iter().flatten()) {
        *target += factor * other;
    }
}
