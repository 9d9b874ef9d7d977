//! Continuation: the path of equilibria from the unloaded string to the loaded one, or from a wall without friction to one with it.
//!
//! `R(x, s) = 0`, the balance under a share s of the loads or of the friction, is a path through x and s that begins where an equilibrium is known:
//! at rest on the centre line, or on the frictionless wall. It is followed by its
//! arc length (Riks 1979; Keller 1977), so that it may turn back in s: where it does, at a limit point, the equilibria that began there end.

use super::newton::{self, NewtonOutcome, linearise, tributary_lengths};
use crate::contact::Wall;
use crate::freedom::{DOFS, U, V};
use crate::linalg::{BlockTridiagonal, Factor};
use crate::model::{Model, NodalVector};
use crate::scenario::ContactLaw;

/// First step along the path, in shares or radii of the hole, whichever are more.
const FIRST_STEP: f64 = 0.05;

/// The shortest step: of a path that needs shorter ones the search has lost hold.
const SHORTEST_STEP: f64 = 1e-9;

/// Linearisations after which a path is left.
const MOST_LINEARISATIONS: usize = 4000;

/// Iterations within which a step has to come back to the path.
const MOST_CORRECTIONS: usize = 10;

/// Last correction at which it has, in the largest displacement (or 1 m, 1 rad), and of the share.
const ON_THE_PATH: f64 = 1e-8;

/// Follows the equilibria from the unloaded string to `load`, and moves `displacement` to the one there; `None` where the path does not come
/// there or the search loses hold of it.
///
/// A `spring` per length \[N/m2\] holds the string on the centre line to begin with and fades as the loads grow. Without one, the path is that of
/// the string under a growing share of its loads. With one it begins also where a string without loads has no stiffness, such as a pendulum.
pub(super) fn follow(
    model: &Model,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
    spring: f64,
) -> Option<NewtonOutcome> {
    let start = vec![[0.0; DOFS]; load.len()];
    match Path::new(model, load, Grown::Loads { spring }).follow(start, displacement) {
        End::Found(outcome) => Some(outcome),
        End::TurnedBack { .. } | End::Lost => None,
    }
}

/// Follows the equilibria under `load` as the friction of the wall grows, from the one on [a wall without](frictionless), at `displacement`,
/// which is moved to the one with it.
pub(super) fn with_growing_friction(
    model: &Model,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
) -> End {
    let start = displacement.clone();
    Path::new(model, load, Grown::Friction { none: frictionless(model) }).follow(start, displacement)
}

/// The model's wall without friction.
pub(super) fn frictionless(model: &Model) -> Wall {
    with_friction(model, 0.0)
}

/// The model's wall with a share of its friction.
fn with_friction(model: &Model, share: f64) -> Wall {
    let own = &model.scenario.contact;
    let law = ContactLaw {
        static_friction: share * own.static_friction,
        dynamic_friction: share * own.dynamic_friction,
        ..*own
    };
    model.wall.with_law(&law, &model.effects)
}

/// Where a path led.
pub(super) enum End {
    /// To the whole of what grows.
    Found(NewtonOutcome),
    /// Back to where it began, from this share at most: there is no further equilibrium on it.
    TurnedBack { share: f64 },
    /// The search has lost hold of it.
    Lost,
}

/// What grows along a path.
enum Grown {
    /// The loads, while a spring per length \[N/m2\] to the centre line fades.
    Loads { spring: f64 },
    /// The wall's friction.
    Friction {
        /// The wall without.
        none: Wall,
    },
}

struct Path<'a> {
    model: &'a Model,
    load: &'a [[f64; DOFS]],
    grown: Grown,
    tributary: Vec<f64>,
    held: Vec<[bool; DOFS]>,
    linearisations: usize,
}

/// A point of the path, or a direction along it.
#[derive(Clone)]
struct Point {
    displacement: NodalVector,
    share: f64,
}

impl Point {
    fn plus(&self, factor: f64, other: &Self) -> Self {
        let mut sum = self.clone();
        add(&mut sum.displacement, factor, &other.displacement);
        sum.share += factor * other.share;
        sum
    }
}

impl<'a> Path<'a> {
    fn new(model: &'a Model, load: &'a [[f64; DOFS]], grown: Grown) -> Self {
        let held = (0..model.node_count()).map(|node| model.held_by_top(node)).collect();
        Self { model, load, grown, tributary: tributary_lengths(model), held, linearisations: 0 }
    }

    fn follow(mut self, start: NodalVector, displacement: &mut NodalVector) -> End {
        let mut here = Point { displacement: start, share: 0.0 };
        let mut most = 0.0_f64;
        let mut last_direction: Option<Point> = None;
        let mut step = FIRST_STEP;
        loop {
            let Some(direction) = self.direction(&here, last_direction.as_ref()) else { return End::Lost };
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
                    if let Some(outcome) = newton::finish(self.model, self.load, &mut at_load) {
                        *displacement = at_load;
                        return End::Found(outcome);
                    }
                }
                step *= 0.5;
                if step < SHORTEST_STEP || self.linearisations > MOST_LINEARISATIONS {
                    return End::Lost;
                }
            };
            here = next;
            last_direction = Some(direction);
            most = most.max(here.share);
            if here.share < 0.0 {
                return End::TurnedBack { share: most };
            }
            step *= match corrections {
                ..=3 => 2.0,
                4..=5 => 1.4,
                _ => 1.0,
            };
        }
    }

    /// The direction of the path at a point, of length 1, onwards from the last one.
    fn direction(&mut self, here: &Point, last: Option<&Point>) -> Option<Point> {
        let (_, factor, slope) = self.linearised(here)?;
        let mut displacement = slope;
        factor.solve_in_place(&mut displacement);
        let size = (self.product(&displacement, &displacement) + 1.0).sqrt();
        let onwards = last.map_or(1.0, |last| self.product(&displacement, &last.displacement) + last.share);
        let share = (1.0 / size).copysign(onwards);
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
            // What leads further away than the step itself leads to another path.
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

    /// Unbalanced forces at a point, the factor of their tangent, and their derivative by the share.
    fn linearised(&mut self, at: &Point) -> Option<(NodalVector, Factor, NodalVector)> {
        self.linearisations += 1;
        let (residual, tangent, slope) = match &self.grown {
            Grown::Loads { spring } => self.with_share_of_loads(at, *spring),
            Grown::Friction { none } => self.with_share_of_friction(at, none),
        };
        Some((residual, Factor::new(&tangent).ok()?, slope))
    }

    fn with_share_of_friction(
        &self,
        at: &Point,
        none: &Wall,
    ) -> (NodalVector, BlockTridiagonal, NodalVector) {
        let on = |wall: &Wall| linearise(self.model, wall, self.load, &at.displacement);
        let (residual, tangent) = on(&with_friction(self.model, at.share));
        // Friction is in proportion to its share.
        let (mut slope, (without, _)) = (on(&self.model.wall).0, on(none));
        add(&mut slope, -1.0, &without);
        (residual, tangent, slope)
    }

    fn with_share_of_loads(&self, at: &Point, spring: f64) -> (NodalVector, BlockTridiagonal, NodalVector) {
        let share = at.share;
        let carried: NodalVector = self.load.iter().map(|load| load.map(|value| share * value)).collect();
        let (mut residual, mut tangent): (_, BlockTridiagonal) =
            linearise(self.model, &self.model.wall, &carried, &at.displacement);
        let mut slope = self.load.to_vec();
        for (node, length) in self.tributary.iter().enumerate() {
            let stiffness = spring * length;
            for dof in [U, V] {
                let displacement = at.displacement[node][dof];
                residual[node][dof] -= (1.0 - share) * stiffness * displacement;
                slope[node][dof] += stiffness * displacement;
                tangent.diagonal[node][(dof, dof)] += (1.0 - share) * stiffness;
            }
            for dof in (0..DOFS).filter(|&dof| self.held[node][dof]) {
                (residual[node][dof], slope[node][dof]) = (0.0, 0.0);
            }
        }
        (residual, tangent, slope)
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
fn add(target: &mut [[f64; DOFS]], factor: f64, other: &[[f64; DOFS]]) {
    for (target, other) in target.iter_mut().flatten().zip(other.iter().flatten()) {
        *target += factor * other;
    }
}
