//! Data kept of a run: its reported results, node by node.

use drillsweep_scenario::{TimeStepping, TimeWindow};

use super::results::Quantity;
use crate::summary::energy_residual_ratio;
use drillsweep_sim::math::dof::{U, V};
use drillsweep_sim::math::signal::{
    FullSpectrum, Window, full_spectrum, sample_range, weighted_orbit_statistics,
};
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::run::{MotionRegime, NodeHistory, Records};
use drillsweep_sim::solve::statics::Equilibrium;

/// Number of members whose histories are kept: one for comparison, and one that parts from it.
const MEMBERS_WITH_HISTORIES: u32 = 2;

/// Data that a study keeps of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    pub(crate) stepping: TimeStepping,
    pub(crate) elements: usize,
    pub(crate) steps: u64,
    pub(crate) subdivisions: u32,
    /// The longest step made \[s\].
    pub(crate) longest_step: f64,
    pub(crate) rate_hz: f64,
    /// Simulated time of the run \[s\].
    pub(crate) simulated_time: f64,
    /// Window of the statistics \[s\].
    pub(crate) window: TimeWindow,
    /// Regime of the motion.
    pub(crate) regime: MotionRegime,
    /// Lateral histories of the recorded nodes; none of members beyond the second, or of runs that settle, each over a window of its own.
    pub(crate) histories: Vec<NodeHistory>,
    pub(crate) nodes: Vec<NodeMeasure>,
    /// Mean over the orbit window of the sum of all normal forces \[N\]; absent for runs that settle, whose window is known at their end.
    pub(crate) contact_force: Option<f64>,
    /// Energy residual over the net work of the contacts; absent without such work.
    pub(crate) energy: Option<f64>,
    pub(crate) error_estimate: f64,
    /// Half the hole's diameter \[m\].
    pub(crate) hole_radius: f64,
    /// Measured depth and static (u, v) of every node.
    pub(crate) position: Vec<(f64, [f64; 2])>,
    /// Measured depth of the lower end and C_f of every element; empty without mud.
    pub(crate) friction: Vec<(f64, f64)>,
}

/// Data kept of a recorded node.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NodeMeasure {
    pub(crate) measured_depth: f64,
    /// Root mean square distance from the mean position \[m\].
    orbit_size: f64,
    /// Standard deviation of the distance from the hole's axis \[m\].
    radius_deviation: f64,
    /// Mean distance from the hole's axis \[m\].
    mean_radius: f64,
    /// Standard deviation of the twist's rate \[rad/s\].
    torsional_speed: f64,
    /// Full spectrum over the last spectrum window; absent without one.
    pub(crate) spectrum: Option<FullSpectrum>,
}

impl Measure {
    /// Keeps the data of a run, the `member` of its ensemble, that the study compares.
    pub fn new(model: &Model, equilibrium: &Equilibrium, records: &Records, member: u32) -> Self {
        let scenario = &model.scenario;
        let settling = &records.settling;
        let orbit_window = settling.window;
        let spectrum_window = records.spectrum_windows(scenario).last().copied();
        let node = |history: &NodeHistory| {
            let depth = model.mesh.nodes[history.node].measured_depth;
            NodeMeasure::new(
                depth,
                history,
                records.rate_hz,
                (orbit_window, settling.weighting),
                spectrum_window,
            )
        };
        let samples = records.histories.first().map_or(0, |history| history.u.len());
        let counted = sample_range(orbit_window.from, orbit_window.to, records.rate_hz, samples).len();
        let impulse: f64 = records.contacts.iter().map(|contact| contact.impulse).sum();
        let kept = if member < MEMBERS_WITH_HISTORIES && !scenario.settles() {
            records.histories.as_slice()
        } else {
            &[]
        };
        let lateral = |history: &NodeHistory| NodeHistory {
            node: history.node,
            u: history.u.clone(),
            v: history.v.clone(),
            ..NodeHistory::default()
        };
        let nodes = model.mesh.nodes.iter().zip(&equilibrium.displacement);
        let elements = model.mesh.elements.iter().zip(&equilibrium.flows);
        Self {
            stepping: records.effort.stepping,
            elements: model.elements.len(),
            steps: records.effort.steps,
            subdivisions: records.effort.subdivisions,
            longest_step: records.effort.step_range[1],
            rate_hz: records.rate_hz,
            simulated_time: records.simulated_time,
            window: orbit_window,
            regime: settling.regime,
            histories: kept.iter().map(lateral).collect(),
            nodes: records.histories.iter().map(node).collect(),
            contact_force: (!scenario.settles()).then(|| impulse * records.rate_hz / counted.max(1) as f64),
            energy: energy_residual_ratio(records),
            error_estimate: records.error.relative,
            hole_radius: 0.5 * scenario.well.hole_diameter,
            position: nodes.map(|(node, x)| (node.measured_depth, [x[U], x[V]])).collect(),
            friction: elements
                .map(|(element, flow)| (element.top + element.length, flow.friction_coefficient))
                .collect(),
        }
    }

    /// Static (u, v) at a depth, between the nodes on a straight line.
    pub(crate) fn position_at(&self, depth: f64) -> [f64; 2] {
        let below =
            self.position.partition_point(|(node, _)| *node < depth).clamp(1, self.position.len() - 1);
        let ((top, a), (bottom, b)) = (self.position[below - 1], self.position[below]);
        let share = ((depth - top) / (bottom - top)).clamp(0.0, 1.0);
        [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
    }

    /// C_f of the element at a depth.
    pub(crate) fn friction_at(&self, depth: f64) -> Option<f64> {
        let element = self.friction.partition_point(|(bottom, _)| *bottom < depth);
        self.friction.get(element).or(self.friction.last()).map(|(_, friction)| *friction)
    }

    /// A statistic of the whole string, or of a recorded node.
    pub(crate) fn statistic(&self, quantity: Quantity, node: usize) -> f64 {
        let of_node = |value: fn(&NodeMeasure) -> f64| self.nodes.get(node).map_or(0.0, value);
        match quantity {
            Quantity::OrbitSize => of_node(|node| node.orbit_size),
            Quantity::RadiusDeviation => of_node(|node| node.radius_deviation),
            Quantity::MeanRadius => of_node(|node| node.mean_radius),
            Quantity::TorsionalSpeed => of_node(|node| node.torsional_speed),
            Quantity::ContactForce => self.contact_force.unwrap_or(0.0),
            // Lines are not one number: they are compared one by one.
            Quantity::Lines => 0.0,
        }
    }
}

impl NodeMeasure {
    /// Statistics over the samples of the windows; zero if a window has none.
    pub(crate) fn new(
        measured_depth: f64,
        history: &NodeHistory,
        rate_hz: f64,
        (orbit_window, weighting): (TimeWindow, Window),
        spectrum_window: Option<TimeWindow>,
    ) -> Self {
        let cut = |window: TimeWindow| sample_range(window.from, window.to, rate_hz, history.u.len());
        let samples = cut(orbit_window);
        let (u, v) = (&history.u[samples.clone()], &history.v[samples.clone()]);
        let orbit = weighted_orbit_statistics(u, v, weighting);
        let spectrum = |window| {
            let samples = cut(window);
            full_spectrum(&history.u[samples.clone()], &history.v[samples], rate_hz, Window::Hann)
        };
        Self {
            measured_depth,
            orbit_size: orbit.map_or(0.0, |orbit| orbit.orbit_radius_rms),
            radius_deviation: orbit.map_or(0.0, |orbit| orbit.radius_deviation),
            mean_radius: orbit.map_or(0.0, |orbit| orbit.mean_radius),
            torsional_speed: history
                .theta_z_rate
                .get(samples)
                .map_or(0.0, |rates| deviation(rates, weighting)),
            spectrum: spectrum_window.map(spectrum),
        }
    }
}

/// Standard deviation of weighted samples about their mean.
fn deviation(values: &[f64], weighting: Window) -> f64 {
    let weights = || (0..values.len()).map(|n| weighting.weight(n, values.len()));
    let total = weights().sum::<f64>().max(f64::MIN_POSITIVE);
    let mean = |value: &dyn Fn(f64) -> f64| {
        values.iter().zip(weights()).map(|(&sample, weight)| weight * value(sample)).sum::<f64>() / total
    };
    let centre = mean(&|sample| sample);
    mean(&|sample| (sample - centre).powi(2)).sqrt()
}
