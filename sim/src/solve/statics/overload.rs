//! Loads beyond the string's stability, under which there may be no equilibrium, or no stable one.

use std::f64::consts::PI;
use std::fmt;

use drillsweep_scenario::TopCondition;
use nalgebra::{SMatrix, SymmetricEigen, Vector3};

use crate::math::dof::{DOFS, THETA_X, THETA_Y};
use crate::math::linalg::{Block, BlockTridiagonal};
use crate::solve::model::{Model, NodalVector, add_element_matrix, clear_held};

/// Size up to which an eigenvalue of a pivot block, whose diagonal is scaled to 1, counts as zero.
const ZERO: f64 = 1e-9;

/// Number of roundings of a stiffness' largest entry that may add up to a resistance against turning: some for each of a row's entries.
const ROUNDING: f64 = 16.0;

/// A string that is not stable at any equilibrium it may have. Even with all nodes held by the wall, or under its loads without a wall, its
/// stiffness has negative eigenvalues, or none at all against turning about its top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overload {
    /// Number of negative eigenvalues.
    pub negative_eigenvalues: usize,
    /// Number of rotations of the whole string about its pinned top that nothing resists.
    pub free_rotations: usize,
    /// True if the eigenvalues are those of a string whose nodes are all held by the wall.
    pub held_by_wall: bool,
    /// Measured depth \[m\] of the upper end of the most loaded part.
    pub measured_depth: f64,
    /// Its length \[m\]: an element, since the wall holds its nodes; the whole string without a wall.
    pub length: f64,
    /// Compression \[N\], with the flow's momentum.
    pub compression: f64,
    /// Torque \[N m\].
    pub torque: f64,
    /// `P / P_Euler + (T / T_Greenhill)^2`, pinned ends.
    pub ratio: f64,
}

impl fmt::Display for Overload {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.negative_eigenvalues == 0 {
            return write!(
                formatter,
                "nothing holds the string: it has no wall, and neither tension nor stiffness resists its turning about the pinned top"
            );
        }
        write!(
            formatter,
            "the string is physically unstable: {} eigenvalues of its stiffness are negative{}; {:.2} m at {:.1} m depth carry {:.1} kN of \
             compression and {:.2} kN m of torque, {:.3} times their buckling load between pinned ends",
            self.negative_eigenvalues,
            if self.held_by_wall { " even if the wall holds every node" } else { "" },
            self.length,
            self.measured_depth,
            self.compression / 1e3,
            self.torque / 1e3,
            self.ratio
        )
    }
}

/// Verdict of a failed search on the physics, in words.
pub(super) fn verdict(overload: Option<&Overload>) -> String {
    overload.map_or_else(
        || "the string is not shown to be unstable: the search itself failed".to_owned(),
        Overload::to_string,
    )
}

/// The instability that the string has in every position, if there is one, with its most loaded part.
///
/// Compression follows from the balance along the string and does not depend on its position: it is summed up from the bit along the buoyed
/// weight, without the mud's drag; torque is the bit's. Contact acts on the lateral displacements of nodes, so that it holds the string at
/// most as bearings there do, which leave rotations free. A wall along the elements resists their deflection between the nodes too, at most with its
/// whole stiffness. Without a wall, follower loads at the end of the string (torque, flow) are left out, so that the
/// stiffness is symmetric. If the stiffness of the string is negative in some direction with all these
/// displacements held, it is so at every equilibrium. A shaft with pinned ends under thrust P and torque T buckles if P / (EI) + (T / 2EI)^2 =
/// (pi / l)^2 (Greenhill 1883).
pub(super) fn find(model: &Model) -> Option<Overload> {
    let string = model.mesh.length();
    let held_by_wall = model.effects.contact;
    let torque = if model.effects.torque_stiffening { model.scenario.operation.torque_on_bit } else { 0.0 };
    let mut tension = model.scenario.operation.weight_on_bit;
    let mut stiffness = BlockTridiagonal::zeros(model.node_count());
    let mut worst = Overload {
        negative_eigenvalues: 0,
        free_rotations: 0,
        held_by_wall,
        measured_depth: 0.0,
        length: string,
        compression: 0.0,
        torque,
        ratio: f64::NEG_INFINITY,
    };
    for (e, element) in model.elements.iter().enumerate().rev() {
        tension += 0.5 * element.axial_weight;
        let bending = element.beam.section().bending_stiffness();
        let momentum =
            element.momentum.filter(|_| model.effects.flow_stiffness).map_or(0.0, |flow| flow.lateral_flux());
        let by_tension =
            element.tension_unit.map_or(element.elastic, |unit| element.elastic + unit * tension);
        let mut own = if held_by_wall { element.stiffness(tension, torque) } else { by_tension };
        // A wall along the element resists its deflection between the nodes with no more than its whole stiffness everywhere.
        if !model.wall.segments().is_empty() {
            let bedding = model.scenario.contact.stiffness_of_a_metre();
            own += element.chord.matrix_to_nodes(&element.beam.lateral_mass()) * bedding;
        }
        add_element_matrix(&mut stiffness, e, &own);
        let thrust = if model.effects.axial_stiffening { -tension } else { 0.0 };
        tension += 0.5 * element.axial_weight;
        let compression = thrust + momentum;
        let length = if held_by_wall { element.beam.length() } else { string };
        let ratio = (compression / bending + (0.5 * torque / bending).powi(2)) * (length / PI).powi(2);
        if ratio > worst.ratio {
            let measured_depth = if held_by_wall { model.mesh.elements[e].top } else { 0.0 };
            worst = Overload { measured_depth, length, compression, ratio, ..worst };
        }
    }
    let free_rotations = free_rotations(model, &stiffness);
    let negative_eigenvalues = negative_directions(model, stiffness);
    let is_unstable = negative_eigenvalues > 0 || free_rotations > 0;
    is_unstable.then_some(Overload { negative_eigenvalues, free_rotations, ..worst })
}

/// Number of the two lateral directions at its pinned top in which a string without a wall turns as a whole, its stiffness resisting by no
/// more than rounding.
fn free_rotations(model: &Model, stiffness: &BlockTridiagonal) -> usize {
    if model.effects.contact || model.scenario.operation.top != TopCondition::Pinned {
        return 0;
    }
    let Some(top) = model.frames.first() else { return 0 };
    let turns_freely = |axis: &Vector3<f64>| {
        let turned: NodalVector = model
            .frames
            .iter()
            .map(|frame| {
                let displacement = axis.cross(&(frame.position - top.position));
                let axes = [frame.e1, frame.e2, frame.e3];
                let [u, v, w] = axes.map(|e| e.dot(&displacement));
                let [x, y, z] = axes.map(|e| e.dot(axis));
                [u, v, w, x, y, z]
            })
            .collect();
        let mut forces = turned.clone();
        stiffness.multiply_into(&turned, &mut forces);
        let size = |vector: &NodalVector| vector.as_flattened().iter().map(|x| x * x).sum::<f64>().sqrt();
        let entries = stiffness.diagonal.iter().flat_map(|block| block.columns.iter().flatten());
        let largest = entries.fold(0.0_f64, |most, entry| most.max(entry.abs()));
        let products = turned.as_flattened().iter().zip(forces.as_flattened());
        products.map(|(x, force)| x * force).sum::<f64>()
            <= ROUNDING * f64::EPSILON * largest * size(&turned).powi(2)
    };
    [top.e1, top.e2].iter().filter(|axis| turns_freely(axis)).count()
}

/// Number of directions in which the stiffness is negative, with the lateral displacements of all nodes held if there is a wall.
fn negative_directions(model: &Model, stiffness: BlockTridiagonal) -> usize {
    let nodes = model.node_count();
    let held: Vec<[bool; DOFS]> = (0..nodes)
        .map(|node| {
            let by_top = model.held_by_top(node);
            let bends = |dof: usize| [THETA_X, THETA_Y].contains(&dof);
            std::array::from_fn(|dof| by_top[dof] || (model.effects.contact && !bends(dof)))
        })
        .collect();
    negative_eigenvalues(stiffness, &held)
}

/// Number of negative eigenvalues of the symmetric part of a stiffness without its held degrees of freedom: of its pivot blocks
/// (Sylvester's law of inertia), up to the first that is singular.
pub(crate) fn negative_eigenvalues(mut stiffness: BlockTridiagonal, held: &[[bool; DOFS]]) -> usize {
    clear_held(&mut stiffness, held);
    let matrix = |block: &Block| SMatrix::<f64, DOFS, DOFS>::from_fn(|i, j| block[(i, j)]);
    let mut negative = 0;
    let mut above: Option<SMatrix<f64, DOFS, DOFS>> = None;
    for (node, held) in held.iter().enumerate() {
        let mut pivot = matrix(&stiffness.diagonal[node]);
        pivot = (pivot + pivot.transpose()) * 0.5;
        if let Some(inverse) = above {
            let coupling =
                (matrix(&stiffness.lower[node]) + matrix(&stiffness.upper[node - 1]).transpose()) * 0.5;
            pivot -= coupling * inverse * coupling.transpose();
        }
        for dof in (0..DOFS).filter(|&dof| held[dof]) {
            pivot[(dof, dof)] = 1.0;
        }
        // Rows of stiffness per length and per angle on one scale.
        let scale = pivot.diagonal().map(|value| 1.0 / value.abs().sqrt().max(f64::MIN_POSITIVE));
        let scaled = SMatrix::<f64, DOFS, DOFS>::from_fn(|i, j| scale[i] * pivot[(i, j)] * scale[j]);
        negative += SymmetricEigen::new(scaled).eigenvalues.iter().filter(|value| **value < -ZERO).count();
        // Not `try_inverse`, which does the same and is compiled together with formulas for matrices of up to four rows.
        above = pivot.lu().try_inverse();
        if above.is_none() {
            return negative;
        }
    }
    negative
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Effect, Scenario, Section, SectionKind, SurveyStation, Switch, preset};

    use super::*;

    /// Horizontal drillpipe of 40 elements of 5 m, pushed from below.
    fn pushed(thrust: f64) -> Scenario {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.mud = None;
        scenario.well.survey = [0.0, 200.0]
            .map(|measured_depth| SurveyStation { measured_depth, inclination_deg: 90.0, azimuth_deg: 0.0 })
            .to_vec();
        scenario.string.sections = vec![Section::plain(SectionKind::Drillpipe, 200.0, 0.127, 0.108)];
        scenario.string.gauges.clear();
        scenario.string.unbalance.clear();
        scenario.recording.nodes.clear();
        scenario.mesh.lengths_mut().unwrap().drillpipe = 5.0;
        scenario.operation.weight_on_bit = -thrust;
        scenario.operation.torque_on_bit = 0.0;
        scenario
    }

    #[test]
    fn instability_between_nodes_on_the_wall_begins_at_an_elements_own_load() {
        // Spans of one element each buckle into opposite half waves; for cubic shapes 2 E I / L - P L / 6 of a half wave is zero at
        // 12 E I / L^2 (Przemieniecki 1968), 1 % less for the shear of this pipe. The clamped top is half a span's difference in 40.
        let bending = 2.03e11 * PI / 64.0 * (0.127_f64.powi(4) - 0.108_f64.powi(4));
        let buckles = 12.0 * bending / 25.0;
        let found = |share: f64| find(&Model::new(&pushed(share * buckles)).unwrap());
        assert_eq!(found(0.97), None);
        let overload = found(1.03).unwrap();
        assert!(overload.held_by_wall && overload.negative_eigenvalues > 0, "{overload}");
        assert!((overload.length - 5.0).abs() < 1e-9 && overload.ratio > 1.0, "{overload}");
    }

    #[test]
    fn instability_without_a_wall_begins_at_eulers_load() {
        let bending = 2.03e11 * PI / 64.0 * (0.127_f64.powi(4) - 0.108_f64.powi(4));
        let euler = bending * (0.5 * PI / 200.0).powi(2);
        let found = |share: f64| {
            let mut scenario = pushed(share * euler);
            scenario.effects.set(Effect::Contact, Switch::Off);
            find(&Model::new(&scenario).unwrap())
        };
        assert_eq!(found(0.99), None);
        // In both planes.
        assert_eq!(found(1.01).unwrap().negative_eigenvalues, 2);
    }

    #[test]
    fn pinned_strings_turn_freely_until_tension_or_a_wall_holds_them() {
        let free = |change: fn(&mut Scenario)| {
            let mut scenario = pushed(0.0);
            scenario.operation.top = TopCondition::Pinned;
            scenario.effects.set(Effect::Contact, Switch::Off);
            change(&mut scenario);
            find(&Model::new(&scenario).unwrap()).map_or(0, |found| found.free_rotations)
        };
        assert_eq!(free(|_| ()), 2);
        assert_eq!(free(|scenario| scenario.operation.weight_on_bit = 1e3), 0);
        assert_eq!(free(|scenario| scenario.operation.top = TopCondition::Clamped), 0);
        assert_eq!(free(|scenario| scenario.effects.set(Effect::Contact, Switch::On)), 0);
        // A string that hangs is a pendulum; without the stiffening by its tension it is not.
        let hangs = |scenario: &mut Scenario| {
            scenario.well.survey.iter_mut().for_each(|station| station.inclination_deg = 0.0);
        };
        let mut scenario = pushed(0.0);
        hangs(&mut scenario);
        scenario.operation.top = TopCondition::Pinned;
        scenario.effects.set(Effect::Contact, Switch::Off);
        assert_eq!(find(&Model::new(&scenario).unwrap()), None);
        scenario.effects.set(Effect::AxialStiffening, Switch::Off);
        assert_eq!(find(&Model::new(&scenario).unwrap()).unwrap().free_rotations, 2);
    }
}
