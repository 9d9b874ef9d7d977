//! Newton's method with a pseudo-transient shift for the nonlinear equilibrium.

use super::error::StaticsError;
use super::touch::{contact_along, contact_at};
use crate::force::contact::{Wall, planes};
use crate::force::nodal::Dependence;
use crate::math::dof::{DOFS, THETA_X, THETA_Y, THETA_Z, U, V};
use crate::math::linalg::{Block, BlockTridiagonal, Factor};
use crate::solve::model::{Model, NodalVector, add_element_matrix, add_element_vector, element_values};
use crate::string::beam::{ElementMatrix, ElementVector};

/// Unbalanced force, relative to the largest nodal load, below which the shift is dropped: the iterate is then
/// inside the region where plain Newton converges quadratically.
const PLAIN_NEWTON_BELOW: f64 = 1e-6;

/// Unbalanced force, relative to the largest nodal load, above which plain Newton counts as lost: it began [below a millionth of that
/// load](PLAIN_NEWTON_BELOW), so that a step which leaves more than the loads themselves has left the region where it converges.
const SHIFT_AGAIN_ABOVE: f64 = 10.0;

/// Largest factor by which the shift follows the residual in one iteration, down or up. Otherwise it is in proportion to the residual
/// (switched evolution relaxation, Mulder and van Leer 1985; Kelley and Keyes 1998, who prove that it converges).
const SHIFT_CHANGE: f64 = 10.0;

/// Iterations of plain Newton next to an equilibrium.
pub(super) const LAST_ITERATIONS: usize = 40;

/// Last step of plain Newton next to an equilibrium, in the largest displacement. With metres of sag, rounding leaves more than the tolerance of
/// strings that lie in their hole.
const ARRIVED: f64 = 1e-9;

/// Settings of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct NewtonSettings {
    /// Initial lateral spring per length of string that holds each iterate at the last one \[N/m2\]. Under
    /// weight on bit a long string is buckled without its wall, so that plain Newton from the centre line
    /// diverges; the spring fades with the residual. A beam on a spring k buckles under 2 sqrt(k E I) (Hetenyi 1946): with 3e4 N/m2, the
    /// default, a drillpipe of 1.3 MN m2 holds 390 kN, which exceeds weights on bit.
    pub initial_shift: f64,
    /// Largest lateral displacement of one iteration \[m\]. The default, 0.02, is less than a collar's clearance (28 mm in the base case), so
    /// that no iteration throws a node from one side of the hole into the other.
    pub largest_step: f64,
    /// Iterations after which the search has failed.
    pub iteration_limit: usize,
    /// Last Newton step at which the search has converged \[m, rad\]. The default, 1e-11, is 1e-4 N of contact force at 1e7 N/m; convergence
    /// is quadratic there, so that the next step would be rounding.
    pub tolerance: f64,
}

impl Default for NewtonSettings {
    fn default() -> Self {
        Self { initial_shift: 3e4, largest_step: 0.02, iteration_limit: 400, tolerance: 1e-11 }
    }
}

/// Outcome of a search.
pub(super) struct NewtonOutcome {
    pub(super) iterations: usize,
    pub(super) residual: f64,
}

/// Moves `displacement` to the equilibrium under `load`, on `wall`.
pub(super) fn solve(
    model: &Model,
    wall: &Wall,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
    settings: &NewtonSettings,
) -> Result<NewtonOutcome, StaticsError> {
    let tributary = tributary_lengths(model);
    let mut shift = settings.initial_shift;
    let (mut residual, mut tangent) = linearise(model, wall, load, displacement);
    let mut size = largest(&residual);
    let scale_of_load = largest(load);
    for iteration in 1..=settings.iteration_limit {
        for (block, length) in tangent.diagonal.iter_mut().zip(&tributary) {
            block[(U, U)] += shift * length;
            block[(V, V)] += shift * length;
        }
        if !wall.segments().is_empty() {
            hold_rotations(model, shift, &mut tangent);
        }
        let mut step = residual;
        Factor::new(&tangent)?.solve_in_place(&mut step);
        let lateral = largest_deflection(wall, &step);
        let scale = (settings.largest_step / lateral).min(1.0);
        let mut longest: f64 = 0.0;
        for (node, step) in displacement.iter_mut().zip(&step) {
            for (value, step) in node.iter_mut().zip(step) {
                *value += scale * step;
                longest = longest.max(step.abs());
            }
        }
        (residual, tangent) = linearise(model, wall, load, displacement);
        let new_size = largest(&residual);
        if !new_size.is_finite() {
            break;
        }
        if longest <= settings.tolerance && shift == 0.0 {
            return Ok(NewtonOutcome { iterations: iteration, residual: new_size });
        }
        shift = if new_size <= PLAIN_NEWTON_BELOW * scale_of_load {
            0.0
        } else if shift == 0.0 && new_size > SHIFT_AGAIN_ABOVE * scale_of_load {
            NewtonSettings::default().initial_shift
        } else {
            shift * (new_size / size).clamp(1.0 / SHIFT_CHANGE, SHIFT_CHANGE)
        };
        size = new_size;
    }
    let node = residual
        .iter()
        .enumerate()
        .max_by(|a, b| force(a.1).total_cmp(&force(b.1)))
        .map_or(0, |(node, _)| node + 1);
    Err(StaticsError::NotConverged {
        iterations: settings.iteration_limit,
        residual: largest(&residual),
        node,
        overload: None,
    })
}

/// Adds the rotational part of a lateral spring of `shift` \[N/m2\] along the elements, 2 l^3/105 of each end: between nodes, a wall along the
/// elements pushes by rotations alone.
fn hold_rotations(model: &Model, shift: f64, tangent: &mut BlockTridiagonal) {
    for (e, element) in model.elements.iter().enumerate() {
        let spring = shift * 2.0 / 105.0 * element.chord.length.powi(3);
        for node in [e, e + 1] {
            for dof in [THETA_X, THETA_Y] {
                tangent.diagonal[node][(dof, dof)] += spring;
            }
        }
    }
}

/// The largest lateral displacement of a step \[m\]: of nodes, and of the middles of elements if the wall acts along them.
fn largest_deflection(wall: &Wall, step: &[[f64; DOFS]]) -> f64 {
    let of_nodes = step.iter().fold(0.0_f64, |most, node| most.max(node[U].hypot(node[V])));
    let along = wall.segments().iter().enumerate().map(|(e, segment)| {
        let middle = planes(&element_values(step, e))
            .map(|[a, turn_a, b, turn_b]| 0.5 * (a + b) + 0.125 * segment.length * (turn_a - turn_b));
        middle[0].hypot(middle[1])
    });
    along.fold(of_nodes, f64::max)
}

/// Plain Newton from `displacement` next to an equilibrium under `load`, without a limit on the step.
pub(super) fn finish(
    model: &Model,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
) -> Option<NewtonOutcome> {
    let plain = NewtonSettings {
        initial_shift: 0.0,
        largest_step: f64::INFINITY,
        iteration_limit: LAST_ITERATIONS,
        tolerance: last_step(displacement),
    };
    solve(model, &model.wall, load, displacement, &plain).ok()
}

/// The last step of plain Newton next to an equilibrium at `displacement` \[m, rad\].
pub(super) fn last_step(displacement: &[[f64; DOFS]]) -> f64 {
    let largest = displacement.iter().flatten().fold(0.0_f64, |most, value| most.max(value.abs()));
    NewtonSettings::default().tolerance.max(ARRIVED * largest)
}

/// Unbalanced forces and the exact tangent stiffness, held degrees of freedom made trivial.
pub(super) fn linearise(
    model: &Model,
    wall: &Wall,
    load: &[[f64; DOFS]],
    displacement: &[[f64; DOFS]],
) -> (NodalVector, BlockTridiagonal) {
    linearise_with(model, load, displacement, &WallAtRest { model, wall, displacement })
}

/// Contacts of a string for the equations of its equilibrium.
pub(super) trait Contacts {
    /// Forces and tangent of a node, if it touches.
    fn of_node(&self, node: usize) -> Option<NodeContact>;

    /// Loads and tangent of the wall along an element, if it touches.
    fn of_element(&self, element: usize) -> Option<ElementContact>;
}

/// The wall at given displacements.
pub(super) struct WallAtRest<'a> {
    pub(super) model: &'a Model,
    pub(super) wall: &'a Wall,
    pub(super) displacement: &'a [[f64; DOFS]],
}

impl Contacts for WallAtRest<'_> {
    fn of_node(&self, node: usize) -> Option<NodeContact> {
        let contact = contact_at(self.wall, node, &self.displacement[node], self.model.rotation_speed)?;
        Some(([contact.force_u, contact.force_v, contact.torque_z], contact.tangent))
    }

    fn of_element(&self, element: usize) -> Option<ElementContact> {
        let contact = contact_along(self.wall, element, self.displacement, self.model.rotation_speed)?;
        Some((contact.force, contact.tangent))
    }
}

/// Forces of a node's contact along u and v and the torque about e3, with their derivatives by u and v.
pub(super) type NodeContact = ([f64; 3], [[f64; 2]; 3]);

/// Consistent nodal loads of the wall along an element, with their derivatives by the nodal values.
pub(super) type ElementContact = (ElementVector, ElementMatrix);

/// [`linearise`] with the contacts given.
pub(super) fn linearise_with(
    model: &Model,
    load: &[[f64; DOFS]],
    displacement: &[[f64; DOFS]],
    contacts: &impl Contacts,
) -> (NodalVector, BlockTridiagonal) {
    let n = model.node_count();
    let mut residual = load.to_vec();
    let mut tangent = BlockTridiagonal::zeros(n);
    for (e, element) in model.elements.iter().enumerate() {
        let q = element_values(displacement, e);
        let tension = element.tension_row.dot(&q);
        let torque = element.torque_row.dot(&q);
        let mut stiffness = element.stiffness(tension, torque);
        let forces = stiffness * q + element.load_of_slopes(tension, torque);
        add_element_vector(&mut residual, e, &-forces);
        // T and T0 are linear in the displacements: their own change belongs to the tangent.
        for (unit, of_slopes, row) in [
            (&element.tension_unit, &element.tension_load, &element.tension_row),
            (&element.torque_unit, &element.torque_load, &element.torque_row),
        ] {
            if let Some(unit) = unit {
                let forces: ElementVector = unit * q + of_slopes;
                let change: ElementMatrix = forces * row.transpose();
                stiffness += change;
            }
        }
        if let Some((forces, gradients)) = contacts.of_element(e) {
            add_element_vector(&mut residual, e, &forces);
            stiffness -= gradients;
        }
        add_element_matrix(&mut tangent, e, &stiffness);
    }
    for (node, (residual, diagonal)) in residual.iter_mut().zip(&mut tangent.diagonal).enumerate() {
        let Some((forces, gradients)) = contacts.of_node(node) else { continue };
        for (row, (force, gradient)) in [U, V, THETA_Z].into_iter().zip(forces.into_iter().zip(&gradients)) {
            residual[row] += force;
            diagonal[(row, U)] -= gradient[0];
            diagonal[(row, V)] -= gradient[1];
        }
    }
    let at_rest = model.at_rest(displacement);
    model.add_forces(Dependence::Motion, &at_rest, &mut residual);
    model.add_force_tangents(&at_rest, &mut tangent, None);
    let held: Vec<[bool; DOFS]> = (0..n).map(|node| model.held_by_top(node)).collect();
    crate::solve::model::clear_held(&mut tangent, &held);
    for (node, held) in held.iter().enumerate() {
        for (dof, _) in held.iter().enumerate().filter(|(_, held)| **held) {
            let block: &mut Block = &mut tangent.diagonal[node];
            block[(dof, dof)] = 1.0;
            residual[node][dof] = 0.0;
        }
    }
    (residual, tangent)
}

/// Half the elements on both sides of every node \[m\].
pub(super) fn tributary_lengths(model: &Model) -> Vec<f64> {
    let mut lengths = vec![0.0; model.node_count()];
    for (e, element) in model.elements.iter().enumerate() {
        lengths[e] += 0.5 * element.chord.length;
        lengths[e + 1] += 0.5 * element.chord.length;
    }
    lengths
}

fn force(node: &[f64; DOFS]) -> f64 {
    node.iter().fold(0.0, |m, f| m.max(f.abs()))
}

pub(super) fn largest(residual: &[[f64; DOFS]]) -> f64 {
    residual.iter().fold(0.0, |m, node| if m.is_nan() { m } else { m.max(force(node)) })
}
