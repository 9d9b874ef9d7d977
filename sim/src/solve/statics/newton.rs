//! Newton's method for the nonlinear equilibrium, with steps that are limited at each node by itself.

use super::error::StaticsError;
use super::touch::{contact_along, contact_at};
use crate::force::contact::Wall;
use crate::force::nodal::Dependence;
use crate::math::dof::{DOFS, THETA_X, THETA_Y, THETA_Z, U, V, W};
use crate::math::linalg::{Block, BlockTridiagonal, Factor};
use crate::solve::model::{Model, NodalVector, add_element_matrix, add_element_vector, element_values};
use crate::string::beam::{ElementMatrix, ElementVector};

/// Lateral spring per length of string \[N/m2\] that holds an iterate at the last one at first. Under weight on bit a long string is buckled without
/// its wall, so that plain Newton from the centre line diverges. A beam on a spring k buckles under 2 sqrt(k E I) (Hetenyi 1946): with 3e4 N/m2, a
/// drillpipe of 1.3 MN m2 holds 390 kN, which exceeds weights on bit.
const FIRST_SPRING: f64 = 3e4;

/// Factor by which the spring of a node fades when its whole step is taken, and by whose inverse it grows when the step is limited.
const FADE: f64 = 0.5;

/// Largest spring \[N/m2\], which is of the order of a wall's own stiffness per metre.
const LARGEST_SPRING: f64 = 1e7;

/// Spring \[N/m2\] that a limited node has at least, and below which a fading spring is released.
const SPRINGS: [f64; 2] = [30.0, 1e-3];

/// Largest lateral step of a node in an iteration \[m\]. It is less than a collar's clearance (28 mm in the base case), so that no iteration throws
/// a node from one side of the hole into the other.
const LARGEST_STEP: f64 = 0.02;

/// Lateral step \[m\] to which a node is always entitled. If all steps are shorter, springs are released: plain Newton ends the search.
const SMALLEST_LIMIT: f64 = 1e-4;

/// Factor by which the limit of a node shrinks if its step reverses the last one, and grows if the limited step goes on in the same direction.
const SHRINK: f64 = 0.5;
const GROW: f64 = 4.0;

/// Iterations after which the search has failed.
const ITERATIONS: usize = 200;

/// Iterations of plain Newton next to an equilibrium.
pub(super) const LAST_ITERATIONS: usize = 40;

/// Last Newton step at which the search has converged \[m, rad\]: 1e-11 is 1e-4 N of contact force at 1e7 N/m, and convergence is quadratic
/// there, so that the next step would be rounding.
const TOLERANCE: f64 = 1e-11;

/// The same in the largest displacement: with metres of stretch or sag, rounding leaves more than [`TOLERANCE`].
const RELATIVE_TOLERANCE: f64 = 1e-9;

/// Beginning of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// Anywhere: springs hold the string at each iterate.
    Anywhere,
    /// Next to the solution: nothing holds it but the limits of the steps.
    NextToSolution,
}

/// Outcome of a search.
pub(super) struct NewtonOutcome {
    pub(super) iterations: usize,
    pub(super) residual: f64,
}

/// Moves `displacement` to the equilibrium under `load`, on `wall`.
///
/// The only strong nonlinearity is contact, which acts node by node: stretch is linear, and tension follows from the first step. So
/// axial and torsional steps are always taken in full, and the lateral step of a node has a limit and a spring to the last iterate of its own, as circuit
/// simulators limit the voltage of each junction (Nagel 1975). A node that leaves and meets the wall in turn shortens its own steps and holds
/// nobody else; what its limit leaves unbalanced along the beam is linear, and the next step removes it.
pub(super) fn solve(
    model: &Model,
    wall: &Wall,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
    start: Start,
) -> Result<NewtonOutcome, StaticsError> {
    let tributary = tributary_lengths(model);
    let spring = if start == Start::Anywhere { FIRST_SPRING } else { 0.0 };
    let mut nodes = vec![NodeLimit { largest: LARGEST_STEP, spring, last: [0.0; 2] }; model.node_count()];
    let (mut residual, mut tangent) = linearise(model, wall, load, displacement);
    for iteration in 1..=ITERATIONS {
        hold(model, wall, &nodes, &tributary, &mut tangent);
        let mut step = residual;
        Factor::new(&tangent)?.solve_in_place(&mut step);
        let (mut longest, mut lateral) = (0.0_f64, 0.0_f64);
        for ((at, node), step) in displacement.iter_mut().zip(&mut nodes).zip(&step) {
            let share = node.share_of([step[U], step[V]]);
            for (dof, (value, step)) in at.iter_mut().zip(step).enumerate() {
                *value += if matches!(dof, W | THETA_Z) { *step } else { share * step };
                longest = longest.max(step.abs());
            }
            lateral = lateral.max(step[U].hypot(step[V]));
        }
        if lateral < SMALLEST_LIMIT {
            nodes.iter_mut().for_each(|node| node.spring = 0.0);
        }
        (residual, tangent) = linearise(model, wall, load, displacement);
        let unbalanced = largest(&residual);
        if !unbalanced.is_finite() {
            break;
        }
        if longest <= last_step(displacement) && nodes.iter().all(|node| node.spring == 0.0) {
            check_in_hole(model, displacement)?;
            return Ok(NewtonOutcome { iterations: iteration, residual: unbalanced });
        }
    }
    let node = residual
        .iter()
        .enumerate()
        .max_by(|a, b| force(a.1).total_cmp(&force(b.1)))
        .map_or(0, |(node, _)| node + 1);
    Err(StaticsError::NotConverged {
        iterations: ITERATIONS,
        residual: largest(&residual),
        node,
        overload: None,
    })
}

/// Limit of the lateral steps of a node.
#[derive(Debug, Clone)]
struct NodeLimit {
    /// Longest step \[m\].
    largest: f64,
    /// Spring to the last iterate, per length \[N/m2\].
    spring: f64,
    /// Last step that was taken \[m\].
    last: [f64; 2],
}

impl NodeLimit {
    /// Share of a step that the node takes; limit and spring follow from it.
    fn share_of(&mut self, step: [f64; 2]) -> f64 {
        let size = step[0].hypot(step[1]);
        let share = if size > self.largest { self.largest / size } else { 1.0 };
        let taken = share * size;
        let is_reversed = step[0] * self.last[0] + step[1] * self.last[1] < 0.0;
        if is_reversed && taken > 0.5 * self.last[0].hypot(self.last[1]) {
            self.largest = (SHRINK * taken).max(SMALLEST_LIMIT);
        } else if !is_reversed && share < 1.0 {
            self.largest = (GROW * self.largest).min(LARGEST_STEP);
        }
        let [least, released] = SPRINGS;
        self.spring = if share < 1.0 {
            (self.spring / FADE).clamp(least, LARGEST_SPRING)
        } else if FADE * self.spring < released {
            0.0
        } else {
            FADE * self.spring
        };
        self.last = step.map(|step| share * step);
        share
    }
}

/// Adds the springs of the nodes to a tangent. Between nodes, a wall along the elements pushes by rotations alone: there, the rotational part of a
/// lateral spring along the element, 2 l^3/105 of each end, is added too.
fn hold(model: &Model, wall: &Wall, nodes: &[NodeLimit], tributary: &[f64], tangent: &mut BlockTridiagonal) {
    for ((block, node), length) in tangent.diagonal.iter_mut().zip(nodes).zip(tributary) {
        block[(U, U)] += node.spring * length;
        block[(V, V)] += node.spring * length;
    }
    if wall.segments().is_empty() {
        return;
    }
    for (e, element) in model.elements.iter().enumerate() {
        let spring = nodes[e].spring.max(nodes[e + 1].spring) * 2.0 / 105.0 * element.chord.length.powi(3);
        for node in [e, e + 1] {
            for dof in [THETA_X, THETA_Y] {
                tangent.diagonal[node][(dof, dof)] += spring;
            }
        }
    }
}

/// Plain Newton from `displacement` next to an equilibrium under `load`, without a limit on the step.
pub(super) fn finish(
    model: &Model,
    load: &[[f64; DOFS]],
    displacement: &mut NodalVector,
) -> Option<NewtonOutcome> {
    let (mut residual, mut tangent) = linearise(model, &model.wall, load, displacement);
    for iteration in 1..=LAST_ITERATIONS {
        let mut step = residual;
        Factor::new(&tangent).ok()?.solve_in_place(&mut step);
        for (value, step) in displacement.iter_mut().flatten().zip(step.iter().flatten()) {
            *value += step;
        }
        (residual, tangent) = linearise(model, &model.wall, load, displacement);
        let unbalanced = largest(&residual);
        if !unbalanced.is_finite() {
            return None;
        }
        if largest(&step) <= last_step(displacement) {
            check_in_hole(model, displacement).ok()?;
            return Some(NewtonOutcome { iterations: iteration, residual: unbalanced });
        }
    }
    None
}

/// Refuses positions of the string outside the hole. Without a wall it may sag to anywhere.
pub(super) fn check_in_hole(model: &Model, displacement: &[[f64; DOFS]]) -> Result<(), StaticsError> {
    let farthest = model.farthest();
    let radii = displacement.iter().map(|at| at[U].hypot(at[V])).enumerate();
    match radii.max_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((node, radius)) if model.effects.contact && radius > farthest => {
            Err(StaticsError::OutsideHole { node: node + 1, radius, farthest })
        }
        _ => Ok(()),
    }
}

/// The last step of Newton's method next to an equilibrium at `displacement` \[m, rad\].
pub(super) fn last_step(displacement: &[[f64; DOFS]]) -> f64 {
    TOLERANCE.max(RELATIVE_TOLERANCE * largest(displacement))
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
        let contact = contact_at(self.wall, node, &self.displacement[node], self.model.body_motion())?;
        Some(([contact.force_u, contact.force_v, contact.torque_z, contact.force_w], contact.tangent))
    }

    fn of_element(&self, element: usize) -> Option<ElementContact> {
        let contact = contact_along(self.wall, element, self.displacement, self.model.body_motion())?;
        Some((contact.force, contact.tangent))
    }
}

/// Forces of a node's contact on the [degrees of freedom](CONTACT_DOFS) of contact, with their derivatives by u and v.
pub(super) type NodeContact = ([f64; CONTACT_DOFS.len()], [[f64; 2]; CONTACT_DOFS.len()]);

/// Degrees of freedom on which contact of a node acts.
pub(super) const CONTACT_DOFS: [usize; 4] = [U, V, THETA_Z, W];

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
        for (row, (force, gradient)) in CONTACT_DOFS.into_iter().zip(forces.into_iter().zip(&gradients)) {
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
