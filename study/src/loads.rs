//! Largest loads of a run, and their depths.

use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{ElementLoads, LoadRecords, NodeLoads, SHOCKS_G, Span};
use serde::Serialize;

/// Share of the time from which a node whirls in one sense, and from which it rolls.
const WHIRLS: f64 = 0.9;
const ROLLS: f64 = 0.5;

/// Orbit size over the clearance from which a node whirls: less is a vibration about a place in the hole.
const WIDE: f64 = 0.1;

/// Loads of a whole string over the window of its statistics.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoadSummary {
    /// Largest orbit size \[m\].
    pub orbit_size: Worst,
    /// Largest root mean square lateral acceleration \[m/s2\].
    pub lateral_acceleration_rms: Worst,
    /// Largest lateral acceleration \[m/s2\].
    pub lateral_acceleration: Worst,
    /// Largest axial acceleration \[m/s2\].
    pub axial_acceleration: Worst,
    /// Largest acceleration of the surface by torsion \[m/s2\].
    pub tangential_acceleration: Worst,
    /// Highest rates of shocks above each of [`SHOCKS_G`] \[1/s\].
    pub shock_rates: [Worst; SHOCKS_G.len()],
    /// Largest mean normal force of the wall \[N\].
    pub side_force: Worst,
    /// Mean power of friction against sliding, of all nodes \[W\].
    pub sliding_power: f64,
    /// Largest bending moment \[N m\].
    pub bending_moment: Worst,
    /// Largest bending stress \[Pa\].
    pub bending_stress: Worst,
    /// Largest axial stress by the effective tension \[Pa\].
    pub axial_stress: Worst,
    /// Largest shear stress by the torque \[Pa\].
    pub torsional_stress: Worst,
    /// Largest equivalent stress \[Pa\].
    pub equivalent_stress: Worst,
    /// Largest equivalent stress over the yield strength; absent if no element has a grade.
    pub yield_ratio: Option<Worst>,
    /// Largest part of the life that fatigue takes by time \[1/s\]; absent if no element has a grade.
    pub fatigue_rate: Option<Worst>,
    /// Rotation speed of the bit \[rad/s\].
    pub bit_speed: Span,
    /// Stick-slip severity of the bit; absent without a mean rotation.
    pub bit_severity: Option<f64>,
    /// Share of the time in which the bit sticks; absent if the string does not rotate.
    pub bit_stick_fraction: Option<f64>,
    /// Torque of the uppermost element \[N m\].
    pub torque_top: Span,
    /// Share of the string's length that whirls backward about the hole's axis for at least nine tenths of the time, in orbits of at least a tenth of
    /// the clearance.
    pub backward_fraction: f64,
    /// Share that whirls forward for at least nine tenths of the time.
    pub forward_fraction: f64,
    /// Share that rolls on the wall for at least half of the time.
    pub rolling_fraction: f64,
    /// Fastest whirl about the hole's axis \[rad/s\] of the nodes that whirl in one sense; absent if none does.
    pub fastest_whirl: Option<Worst>,
    /// Loads of the recorded nodes, each with its number from 1 and the element above it, of the first node the one below it.
    pub recorded: Vec<(usize, NodeLoads, ElementLoads)>,
}

/// Largest value along the string.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Worst {
    /// Value.
    pub value: f64,
    /// Measured depth \[m\], of an element that of its lower end.
    pub measured_depth: f64,
}

impl LoadSummary {
    /// Summary of the loads of a run that records the nodes `recorded`, from 0; absent if no step ended in the window.
    pub fn new(model: &Model, loads: &LoadRecords, recorded: &[usize]) -> Option<Self> {
        let LoadRecords { nodes, elements, .. } = loads;
        let bit = nodes.last()?;
        let depth = |node: usize| model.mesh.nodes[node].measured_depth;
        let of_nodes = |value: &dyn Fn(&NodeLoads) -> f64| {
            worst(nodes.iter().enumerate().map(|(node, loads)| (value(loads), depth(node))))
        };
        let of_elements = |value: &dyn Fn(&ElementLoads) -> f64| {
            worst(elements.iter().enumerate().map(|(e, loads)| (value(loads), depth(e + 1))))
        };
        let of_graded = |value: &dyn Fn(&ElementLoads) -> Option<f64>| {
            let mut graded = elements
                .iter()
                .enumerate()
                .filter_map(|(e, loads)| Some((value(loads)?, depth(e + 1))))
                .peekable();
            graded.peek().is_some().then(|| worst(graded))
        };
        let length_of = |is_it: &dyn Fn(usize) -> bool| {
            let at_node = |node: usize| if is_it(node) { 0.5 } else { 0.0 };
            let lengths = model.mesh.elements.iter().enumerate();
            let total: f64 = model.mesh.elements.iter().map(|element| element.length).sum();
            lengths.map(|(e, element)| element.length * (at_node(e) + at_node(e + 1))).sum::<f64>() / total
        };
        let is_wide = |node: usize| nodes[node].orbit_radius_rms >= WIDE * model.mesh.nodes[node].clearance;
        let is_backward = |node: usize| is_wide(node) && nodes[node].forward_fraction <= 1.0 - WHIRLS;
        let is_forward = |node: usize| is_wide(node) && nodes[node].forward_fraction >= WHIRLS;
        let rolls = |node: usize| nodes[node].rolling_fraction.is_some_and(|share| share >= ROLLS);
        let whirling = (0..nodes.len()).filter(|&node| is_backward(node) || is_forward(node));
        Some(Self {
            orbit_size: of_nodes(&|node| node.orbit_radius_rms),
            lateral_acceleration_rms: of_nodes(&|node| node.lateral_acceleration.rms),
            lateral_acceleration: of_nodes(&|node| node.lateral_acceleration.peak.value),
            axial_acceleration: of_nodes(&|node| node.axial_acceleration.peak.value),
            tangential_acceleration: of_nodes(&|node| node.tangential_acceleration.peak.value),
            shock_rates: std::array::from_fn(|threshold| of_nodes(&|node| node.shock_rates[threshold])),
            side_force: of_nodes(&|node| node.side_force),
            sliding_power: nodes.iter().map(|node| node.sliding_power).sum(),
            bending_moment: of_elements(&|element| element.bending_moment.peak.value),
            bending_stress: of_elements(&|element| element.bending_stress),
            axial_stress: of_elements(&|element| element.axial_stress),
            torsional_stress: of_elements(&|element| element.torsional_stress),
            equivalent_stress: of_elements(&|element| element.equivalent_stress.value),
            yield_ratio: of_graded(&|element| element.yield_ratio),
            fatigue_rate: of_graded(&|element| element.fatigue_rate),
            bit_speed: bit.rotation_speed,
            bit_severity: bit.stick_slip_severity(),
            bit_stick_fraction: bit.stick_fraction,
            torque_top: elements.first()?.torque,
            backward_fraction: length_of(&is_backward),
            forward_fraction: length_of(&is_forward),
            rolling_fraction: length_of(&rolls),
            fastest_whirl: whirling
                .max_by(|&a, &b| nodes[a].whirl_speed.abs().total_cmp(&nodes[b].whirl_speed.abs()))
                .map(|node| Worst { value: nodes[node].whirl_speed, measured_depth: depth(node) }),
            recorded: recorded
                .iter()
                .map(|&node| (node + 1, nodes[node], elements[node.saturating_sub(1)]))
                .collect(),
        })
    }
}

/// The largest of values, each with its depth; the uppermost of equal ones.
pub(crate) fn worst(values: impl Iterator<Item = (f64, f64)>) -> Worst {
    let none = Worst { value: f64::NEG_INFINITY, measured_depth: 0.0 };
    values.fold(
        none,
        |worst, (value, measured_depth)| {
            if value > worst.value { Worst { value, measured_depth } } else { worst }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_uppermost_of_equal_values_is_the_worst() {
        let values = [(1.0, 10.0), (3.0, 20.0), (3.0, 30.0), (2.0, 40.0)];
        assert_eq!(worst(values.into_iter()), Worst { value: 3.0, measured_depth: 20.0 });
    }
}
