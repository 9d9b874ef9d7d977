//! Continuation: the path of equilibria from the unloaded string to the loaded one, or from a wall at the nodes to one along the elements.
//!
//! Either path begins at a known equilibrium: at rest on the centre line, or on the wall at the nodes.

use super::newton::{self, NewtonOutcome, linearise, tributary_lengths};
use super::path::{self, Growth, Point};
use crate::force::contact::Wall;
use crate::math::dof::{DOFS, U, V};
use crate::math::linalg::BlockTridiagonal;
use crate::solve::model::{Model, NodalVector};

/// Follows the equilibria from the unloaded string to `load`, and moves `displacement` to the last one; `None` if the path does not reach `load`
/// or the search loses the path.
///
/// A `spring` per length \[N/m2\] holds the string on the centre line at first and fades as the loads grow. Without one, the path is that of
/// the string under a growing share of its loads. With one, the path begins even if a string without loads has no stiffness, such as a pendulum.
pub(super) fn follow(
    model: &Model,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
    spring: f64,
) -> Option<NewtonOutcome> {
    let mut followed = vec![[0.0; DOFS]; load.len()];
    let held = (0..model.node_count()).map(|node| model.held_by_top(node)).collect();
    let loads = Loads { model, load, spring, tributary: tributary_lengths(model), held };
    let outcome = path::follow(model, &loads, &mut followed)?;
    *displacement = followed;
    Some(outcome)
}

/// Follows the equilibria under `load` as the wall moves from the nodes along the elements. The path begins at `displacement`, the equilibrium on the
/// [wall at the nodes](Wall::at_nodes), and moves it to the one along the elements; `None` if the path does not reach it.
pub(super) fn along_the_elements(
    model: &Model,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
) -> Option<NewtonOutcome> {
    path::follow(model, &Spreading { model, load, at_nodes: model.wall.at_nodes() }, displacement)
}

/// The loads grow, while a spring to the centre line fades.
struct Loads<'a> {
    model: &'a Model,
    load: &'a [[f64; DOFS]],
    /// Spring per length \[N/m2\].
    spring: f64,
    tributary: Vec<f64>,
    held: Vec<[bool; DOFS]>,
}

impl Growth for Loads<'_> {
    fn linearise(&self, at: &Point) -> Option<(NodalVector, BlockTridiagonal, NodalVector)> {
        let share = at.share;
        let carried: NodalVector = self.load.iter().map(|load| load.map(|value| share * value)).collect();
        let (mut residual, mut tangent): (_, BlockTridiagonal) =
            linearise(self.model, &self.model.wall, &carried, &at.displacement);
        let mut slope = self.load.to_vec();
        for (node, length) in self.tributary.iter().enumerate() {
            let stiffness = self.spring * length;
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
        Some((residual, tangent, slope))
    }

    fn arrive(&self, displacement: &mut NodalVector) -> Option<NewtonOutcome> {
        newton::finish(self.model, self.load, displacement)
    }
}

/// The wall moves from the nodes along the elements.
struct Spreading<'a> {
    model: &'a Model,
    load: &'a [[f64; DOFS]],
    at_nodes: Wall,
}

impl Growth for Spreading<'_> {
    fn linearise(&self, at: &Point) -> Option<(NodalVector, BlockTridiagonal, NodalVector)> {
        let on = |wall: &Wall| linearise(self.model, wall, self.load, &at.displacement);
        let ((start, start_tangent), (end, end_tangent)) = (on(&self.at_nodes), on(&self.model.wall));
        let mixed = |from: f64, to: f64| at.share.mul_add(to - from, from);
        let nodal = |from: &NodalVector, to: &NodalVector, of: &dyn Fn(f64, f64) -> f64| -> NodalVector {
            let pairs = from.iter().zip(to);
            pairs.map(|(from, to)| std::array::from_fn(|dof| of(from[dof], to[dof]))).collect()
        };
        let tangent = BlockTridiagonal::combine(
            1.0 - at.share,
            &start_tangent,
            at.share,
            &end_tangent,
            0.0,
            &end_tangent,
        );
        let slope = nodal(&start, &end, &|from, to| to - from);
        Some((nodal(&start, &end, &mixed), tangent, slope))
    }

    fn arrive(&self, displacement: &mut NodalVector) -> Option<NewtonOutcome> {
        newton::finish(self.model, self.load, displacement)
    }
}
