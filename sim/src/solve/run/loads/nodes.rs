//! Loads of nodes.

use serde::Serialize;

use super::moment::Moment;
use super::statistics::{Peak, RmsAndPeak, Span, Sums, indicator};
use crate::force::term::gravity;
use crate::force::wall::NodesAtWall;
use crate::math::dof::{Dofs, U, V, W};
use crate::math::linalg::{Four, Lane};
use crate::solve::model::Model;

/// Thresholds of shocks, as multiples of standard gravity: lateral accelerations that start to matter to tools downhole, and those that damage them.
pub const SHOCKS_G: [f64; 2] = [10.0, 50.0];

/// Standard gravity \[m/s2\], the unit of accelerations downhole.
const STANDARD_GRAVITY: f64 = 9.806_65;

/// Share of the nominal rotation speed below which a node sticks, and share of the speed of its surface below which it rolls on the wall.
const STANDSTILL: f64 = 0.05;

/// Loads of one node over the window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NodeLoads {
    /// Root mean square distance from the mean position \[m\].
    pub orbit_radius_rms: f64,
    /// Mean angular speed of the lateral motion about the hole's axis, weighted by the square of the distance \[rad/s\]; positive turns from u to
    /// v.
    pub whirl_speed: f64,
    /// The same about the mean position.
    pub orbit_whirl_speed: f64,
    /// Share of the time in which the node moves forward about the hole's axis.
    pub forward_fraction: f64,
    /// Acceleration across the string \[m/s2\], in the fixed frame.
    pub lateral_acceleration: RmsAndPeak,
    /// Acceleration along the string \[m/s2\].
    pub axial_acceleration: RmsAndPeak,
    /// Acceleration of the surface by the twist \[m/s2\]: outer radius times angular acceleration.
    pub tangential_acceleration: RmsAndPeak,
    /// Reading of an accelerometer across the string that turns with it, on its axis \[m/s2\]: acceleration less gravity along an axis of the section.
    pub turning_acceleration: RmsAndPeak,
    /// Number of times that the lateral acceleration rises above each of [`SHOCKS_G`], by time \[1/s\].
    pub shock_rates: [f64; SHOCKS_G.len()],
    /// Rotation speed \[rad/s\].
    pub rotation_speed: Span,
    /// Share of the time in which the node turns at less than 5 % of the nominal speed, or backward; absent if the string does not rotate.
    pub stick_fraction: Option<f64>,
    /// Normal force of the wall \[N\]: mean over time.
    pub side_force: f64,
    /// Largest normal force of the wall \[N\].
    pub largest_side_force: Peak,
    /// Share of the time in contact with the wall.
    pub contact_fraction: f64,
    /// Share of the time in which the node touches the wall and its surface slides at less than 5 % of the speed of its rotation; absent if the string
    /// does not rotate.
    pub rolling_fraction: Option<f64>,
    /// Mean power of friction against sliding \[W\], which wears casing and string.
    pub sliding_power: f64,
}

impl NodeLoads {
    /// Stick-slip severity of the rotation speed, (largest - least) / (2 mean): 1 if the node just stops at its slowest. Absent without a mean rotation.
    pub fn stick_slip_severity(&self) -> Option<f64> {
        let Span { mean, least, largest } = self.rotation_speed;
        (mean.abs() > f64::MIN_POSITIVE).then(|| 0.5 * (largest - least) / mean.abs())
    }
}

/// Quantities that are integrated.
const U_MEAN: usize = 0;
const V_MEAN: usize = 1;
const DISTANCE_SQUARED: usize = 2;
const U_RATE: usize = 3;
const V_RATE: usize = 4;
/// u v' - v u' \[m2/s\].
const SWEPT: usize = 5;
const FORWARD: usize = 6;
const LATERAL_SQUARED: usize = 7;
const AXIAL_SQUARED: usize = 8;
const TANGENTIAL_SQUARED: usize = 9;
const TURNING_SQUARED: usize = 10;
const SPEED: usize = 11;
const STUCK: usize = 12;
const SIDE_FORCE: usize = 13;
const TOUCHING: usize = 14;
const ROLLING: usize = 15;
const SLIDING_POWER: usize = 16;
const INTEGRALS: usize = 17;

/// Quantities whose largest values are kept.
const LATERAL_PEAK: usize = 0;
const AXIAL_PEAK: usize = 1;
const TANGENTIAL_PEAK: usize = 2;
const TURNING_PEAK: usize = 3;
const LOWEST_SPEED: usize = 4;
const HIGHEST_SPEED: usize = 5;
const SIDE_FORCE_PEAK: usize = 6;
const EXTREMES: usize = 7;

/// Sums of four nodes.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct NodeSums {
    sums: Sums<INTEGRALS, EXTREMES>,
    /// Number of shocks above each threshold.
    shocks: Sums<{ SHOCKS_G.len() }, 0>,
}

/// Nodes of a string, and their last sample.
pub(super) struct Nodes<const D: usize> {
    count: usize,
    groups: Vec<NodeGroup>,
    samples: Vec<[Four; INTEGRALS]>,
    /// Places of w and theta_z in a node's values.
    axial: Option<usize>,
    twist: Option<usize>,
    rotation_speed: f64,
}

/// Constants of four nodes.
#[derive(Debug, Clone, Copy)]
struct NodeGroup {
    /// Outer radius of the string \[m\].
    outer_radius: Four,
    /// Gravity along u and v \[m/s2\].
    gravity: [Four; 2],
    /// Sliding speed \[m/s\] below which the surface rolls on the wall.
    rolling_speed: Four,
}

impl NodeSums {
    pub(super) fn none() -> Self {
        Self { sums: Sums::none(), shocks: Sums::none() }
    }

    pub(super) fn add(&mut self, next: &Self) {
        self.sums.add(&next.sums);
        self.shocks.add(&next.shocks);
    }
}

impl<const D: usize> Nodes<D> {
    pub(super) fn new(model: &Model, freedoms: Dofs<D>) -> Self {
        let (elements, nodes) = (&model.mesh.elements, &model.mesh.nodes);
        let gravity = gravity::acceleration(model.effects.gravity);
        let outer_radius = |node: usize| {
            let adjoining = &elements[node.saturating_sub(1)..(node + 1).min(elements.len())];
            adjoining.iter().fold(0.0, |radius, element| 0.5 * element.tube.outer_diameter.max(2.0 * radius))
        };
        let group = |first: usize| {
            let lanes = |value: &dyn Fn(usize) -> f64| {
                Four::new(std::array::from_fn(|lane| {
                    if first + lane < nodes.len() { value(first + lane) } else { 0.0 }
                }))
            };
            NodeGroup {
                outer_radius: lanes(&outer_radius),
                gravity: [
                    lanes(&|node| gravity * model.frames[node].e1.z),
                    lanes(&|node| gravity * model.frames[node].e2.z),
                ],
                rolling_speed: lanes(&|node| {
                    STANDSTILL * model.rotation_speed.abs() * nodes[node].contact_radius
                }),
            }
        };
        let groups: Vec<_> = (0..nodes.len()).step_by(Four::LANES).map(group).collect();
        Self {
            count: nodes.len(),
            samples: vec![[Four::ZERO; INTEGRALS]; groups.len()],
            groups,
            axial: freedoms.place(W),
            twist: freedoms.twist(),
            rotation_speed: model.rotation_speed,
        }
    }

    /// Number of nodes.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Number of groups of four nodes.
    pub(super) fn groups(&self) -> usize {
        self.groups.len()
    }

    /// True if the top turns.
    pub(super) fn has_rotation(&self) -> bool {
        self.rotation_speed != 0.0
    }

    pub(super) fn start(&mut self, moment: &Moment<'_, D>) {
        for group in 0..self.groups.len() {
            self.samples[group] = self.sample(group, moment);
        }
    }

    pub(super) fn observe(&mut self, moment: &Moment<'_, D>, h: f64, sums: &mut [NodeSums]) {
        let time = Four::splat(moment.time);
        for (group, NodeSums { sums, shocks }) in sums.iter_mut().enumerate() {
            let sample = self.sample(group, moment);
            let before = std::mem::replace(&mut self.samples[group], sample);
            sums.integrate(h, &before, &sample);
            let peak = moment.peaks.get(group).copied().unwrap_or(Four::ZERO);
            let values: [Four; EXTREMES] = [
                sample[LATERAL_SQUARED],
                sample[AXIAL_SQUARED],
                sample[TANGENTIAL_SQUARED],
                sample[TURNING_SQUARED],
                -sample[SPEED],
                sample[SPEED],
                sample[SIDE_FORCE].max(peak),
            ];
            for (extreme, value) in sums.extremes.iter_mut().zip(values) {
                extreme.raise(value, time);
            }
            for (count, threshold) in shocks.integrals.iter_mut().zip(SHOCKS_G) {
                let squared = Four::splat((threshold * STANDARD_GRAVITY).powi(2));
                let rises = !before[LATERAL_SQUARED].greater_than(squared)
                    & sample[LATERAL_SQUARED].greater_than(squared);
                *count = *count + indicator(rises);
            }
        }
    }

    /// Values of a group of four nodes at a moment.
    #[inline(always)]
    fn sample(&self, group: usize, moment: &Moment<'_, D>) -> [Four; INTEGRALS] {
        let NodeGroup { outer_radius, gravity, rolling_speed } = self.groups[group];
        let (x, v, a) = (
            &moment.displacement.groups()[group],
            &moment.velocity.groups()[group],
            &moment.acceleration.groups()[group],
        );
        let of = |values: &[Four; D], place: Option<usize>| place.map_or(Four::ZERO, |place| values[place]);
        let swept = x[U].mul_add(v[V], -(x[V] * v[U]));
        let (axial, tangential) = (of(a, self.axial), of(a, self.twist) * outer_radius);
        let speed = of(v, self.twist) + Four::splat(self.rotation_speed);
        let (sin, cos) = (of(x, self.twist) + Four::splat(moment.angle)).sin_cos();
        let turning = (a[U] - gravity[0]).mul_add(cos, (a[V] - gravity[1]) * sin);
        let forward = speed_sign(self.rotation_speed);
        let NodesAtWall { penetration, normal_force, sliding_speed, sliding_power } =
            moment.wall.nodes_at_wall(group);
        let touches = penetration.greater_than(Four::ZERO);
        let mut values = [Four::ZERO; INTEGRALS];
        values[U_MEAN] = x[U];
        values[V_MEAN] = x[V];
        values[DISTANCE_SQUARED] = x[U].mul_add(x[U], x[V] * x[V]);
        values[U_RATE] = v[U];
        values[V_RATE] = v[V];
        values[SWEPT] = swept;
        values[FORWARD] = indicator((swept * forward).greater_than(Four::ZERO));
        values[LATERAL_SQUARED] = a[U].mul_add(a[U], a[V] * a[V]);
        values[AXIAL_SQUARED] = axial * axial;
        values[TANGENTIAL_SQUARED] = tangential * tangential;
        values[TURNING_SQUARED] = turning * turning;
        values[SPEED] = speed;
        values[STUCK] =
            indicator((speed * forward).less_than(Four::splat(STANDSTILL * self.rotation_speed.abs())));
        values[SIDE_FORCE] = normal_force;
        values[TOUCHING] = indicator(touches);
        values[ROLLING] = indicator(touches & sliding_speed.abs().less_than(rolling_speed));
        values[SLIDING_POWER] = Four::select(touches, sliding_power, Four::ZERO);
        values
    }
}

/// Sense of the rotation; forward if the top does not turn.
fn speed_sign(rotation_speed: f64) -> Four {
    Four::splat(if rotation_speed < 0.0 { -1.0 } else { 1.0 })
}

/// Loads of a node by the sums over `duration` \[s\] of a string whose top turns or does not.
pub(super) fn node_loads(groups: &[NodeSums], node: usize, duration: f64, rotates: bool) -> NodeLoads {
    let (NodeSums { sums, shocks }, lane) = (&groups[node / Four::LANES], node % Four::LANES);
    let mean = |quantity: usize| sums.mean(quantity, lane, duration);
    // The last digit of a sum of steps may exceed their time.
    let share = |quantity: usize| mean(quantity).min(1.0);
    let square = |mean: usize, peak: usize| sums.of_square([mean, peak], lane, duration);
    let [u, v] = [mean(U_MEAN), mean(V_MEAN)];
    let (distance_squared, swept) = (mean(DISTANCE_SQUARED), mean(SWEPT));
    let about_mean = distance_squared - u * u - v * v;
    let swept_about_mean = swept - u * mean(V_RATE) + v * mean(U_RATE);
    // A node that does not move whirls at no speed; below this share, the differences are rounding.
    let speed = |swept: f64, squared: f64| {
        if squared > f64::EPSILON * distance_squared { swept / squared } else { 0.0 }
    };
    NodeLoads {
        orbit_radius_rms: about_mean.max(0.0).sqrt(),
        whirl_speed: speed(swept, distance_squared),
        orbit_whirl_speed: speed(swept_about_mean, about_mean),
        forward_fraction: share(FORWARD),
        lateral_acceleration: square(LATERAL_SQUARED, LATERAL_PEAK),
        axial_acceleration: square(AXIAL_SQUARED, AXIAL_PEAK),
        tangential_acceleration: square(TANGENTIAL_SQUARED, TANGENTIAL_PEAK),
        turning_acceleration: square(TURNING_SQUARED, TURNING_PEAK),
        shock_rates: std::array::from_fn(|threshold| shocks.mean(threshold, lane, duration)),
        rotation_speed: sums.span(SPEED, [LOWEST_SPEED, HIGHEST_SPEED], lane, duration),
        stick_fraction: rotates.then(|| share(STUCK)),
        side_force: mean(SIDE_FORCE),
        largest_side_force: sums.peak(SIDE_FORCE_PEAK, lane),
        contact_fraction: share(TOUCHING),
        rolling_fraction: rotates.then(|| share(ROLLING)),
        sliding_power: mean(SLIDING_POWER),
    }
}
