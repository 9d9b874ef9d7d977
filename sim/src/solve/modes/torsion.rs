//! Torsional modes that velocity-weakening friction and torque on bit excite, up to the frequency at which damping or the mesh ends them.
//!
//! Velocity-weakening friction is a negative damper at every sliding node. It excites torsion at all frequencies alike; only
//! damping that grows with frequency (`damping.stiffness_proportional`) limits it. Without such damping, modes grow up to the highest frequency of
//! the mesh, and mesh and step decide which of them survive. This module solves for twist alone, a chain of shafts from the clamped top to the
//! free bit, about the equilibrium with its contacts closed and sliding at the speed of rotation. It takes some ten milliseconds;
//! [`modes`](super::modes()) takes seconds for the whole spectrum.

use std::f64::consts::TAU;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::mode::limit_of_bit;
use crate::force::bit_rock::WeakeningTorque;
use crate::force::contact::{sliding_segment, sliding_tangent};
use crate::math::dof::THETA_Z;
use crate::solve::model::{Model, element_values};
use crate::solve::statics::Equilibrium;

/// Nodes up to which all modes are computed; of longer chains only the modes below the frequency above which all decay.
const MOST_NODES: usize = 700;

/// Nodes times modes that are computed: some tenths of a second.
const MOST_VALUES: usize = 2_000_000;

/// Relative width to which an eigenvalue is enclosed: far below the distance of neighbours.
const ENCLOSED: f64 = 1e-9;

/// Share of the mesh's highest frequency from which a growing mode counts as limited by the mesh alone.
const MESH_END: f64 = 0.75;

/// Steps in a period with which the reference resolves a mode: no method here damps it as fast as friction excites it.
const STEPS_OF_A_PERIOD: f64 = 20.0;

/// The torsional modes that velocity-weakening friction excites, to first order in damping.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
pub struct UndampedTorsion {
    /// Torsional modes of the mesh.
    pub modes: usize,
    /// Number of growing modes; absent if too many modes may grow to compute each.
    pub growing_modes: Option<usize>,
    /// Frequency of the highest growing mode \[Hz\]; absent if none grows. Without `growing_modes`, the frequency above which all decay,
    /// at most the mesh's highest.
    pub highest_hz: Option<f64>,
    /// Growth of the highest growing mode's amplitude \[1/s\]; absent if none grows, or without `growing_modes`.
    pub highest_growth: Option<f64>,
    /// Largest growth of any computed mode \[1/s\], negative if all decay; without `growing_modes` a bound.
    pub largest_growth: f64,
    /// Highest torsional frequency of the mesh \[Hz\]; without `growing_modes` a bound.
    pub mesh_hz: f64,
    /// True if modes grow up to the highest frequency of the mesh, so that mesh and step decide which torsion survives.
    pub up_to_the_mesh: bool,
    /// True if torque on bit follows the speed of the bit, so that stick-slip of the bit is included.
    #[serde(default)]
    pub includes_bit: bool,
}

/// One mode of twist.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TorsionalMode {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// Growth of its amplitude \[1/s\], to first order in damping; negative is decay.
    pub growth_rate: f64,
}

impl UndampedTorsion {
    /// The assessment of a model about its equilibrium; `None` if twist is not solved for, neither friction nor the bit excites it, or the top of the string
    /// yields.
    pub fn about(model: &Model, equilibrium: &Equilibrium) -> Option<Self> {
        Chain::about(model, equilibrium).map(|chain| chain.assessment())
    }

    /// The longest step \[s\] that resolves the growing modes; absent if none grows.
    pub fn resolving_step(&self) -> Option<f64> {
        self.highest_hz.map(|highest| 1.0 / (STEPS_OF_A_PERIOD * highest))
    }

    /// Warning, in words, that modes grow beyond the vibrations that a run resolves, up to `resolved_hz` \[Hz\]; `None` if the run resolves them.
    pub fn warning(&self, resolved_hz: f64) -> Option<String> {
        let highest = self.highest_hz?;
        if self.up_to_the_mesh {
            return Some(self.to_string());
        }
        (highest > resolved_hz).then(|| {
            format!(
                "torsional modes grow up to {highest:.0} Hz, and steps resolve vibrations up to {resolved_hz:.0} Hz: torsion, and lateral motion with it, depends on the steps"
            )
        })
    }
}

/// All torsional modes of a model about its equilibrium, by frequency; `None` as [`UndampedTorsion::about`]. The time grows with the square
/// of the number of nodes.
pub fn torsional_modes(model: &Model, equilibrium: &Equilibrium) -> Option<Vec<TorsionalMode>> {
    Some(Chain::about(model, equilibrium)?.modes())
}

/// The torsional modes of a model about its equilibrium that grow, up to a frequency \[Hz\], by frequency; none as
/// [`UndampedTorsion::about`]. The time grows with the number of nodes and of modes below that frequency.
pub fn growing_torsion(model: &Model, equilibrium: &Equilibrium, to_hz: f64) -> Vec<TorsionalMode> {
    let Some(chain) = Chain::about(model, equilibrium) else { return Vec::new() };
    let mut modes = chain.modes_below((TAU * to_hz).powi(2));
    modes.retain(|mode| mode.growth_rate > 0.0);
    modes
}

impl fmt::Display for UndampedTorsion {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.highest_hz, self.growing_modes) {
            (None, _) => write!(formatter, "all torsional modes decay{}", limit_of_bit(self.includes_bit)),
            (Some(highest), _) if self.up_to_the_mesh => write!(
                formatter,
                "torsional modes grow up to {highest:.0} Hz, where the mesh ends ({:.0} Hz): velocity-weakening friction excites them, and damping.stiffness_proportional does not suppress it, so torsion, and lateral motion with it, depends on mesh and step",
                self.mesh_hz
            ),
            (Some(highest), Some(count)) => write!(
                formatter,
                "{count} torsional modes grow, the highest at {highest:.1} Hz; all above decay{}",
                limit_of_bit(self.includes_bit)
            ),
            (Some(highest), None) => {
                write!(
                    formatter,
                    "torsional modes may grow up to {highest:.1} Hz and decay above{}",
                    limit_of_bit(self.includes_bit)
                )
            }
        }
    }
}

/// Twist of the nodes below the top: a symmetric tridiagonal pencil with a damper at every node.
struct Chain {
    /// Diagonal of the inertia matrix \[kg m2\].
    inertia: Vec<f64>,
    /// Inertia between a node and the next; the last is not used.
    inertia_to_next: Vec<f64>,
    /// Diagonal of the stiffness matrix \[N m\].
    stiffness: Vec<f64>,
    /// Stiffness between a node and the next (negative).
    stiffness_to_next: Vec<f64>,
    /// Damping added by sliding friction at each node \[N m s\]; negative if friction excites torsion.
    rubbing: Vec<f64>,
    /// alpha \[1/s\] and beta \[s\] of Rayleigh damping.
    rayleigh: [f64; 2],
    /// True if torque on bit follows the speed of the bit.
    includes_bit: bool,
}

/// Damping of twist by friction of the closed contacts at every node \[N m s\], the string turning at a speed \[rad/s\]; negative where friction excites torsion.
pub(in crate::solve) fn rubbing(model: &Model, equilibrium: &Equilibrium, speed: f64) -> Vec<f64> {
    let mut rubbing = vec![0.0; model.node_count()];
    for (node, site) in model.wall.touchable() {
        let [u, v, ..] = equilibrium.displacement[node];
        if let Some(tangent) = sliding_tangent(model.wall.law(), site, u, v, speed) {
            rubbing[node] = tangent.damping[2][2];
        }
    }
    for (e, segment) in model.wall.segments().iter().enumerate() {
        let values = element_values(&equilibrium.displacement, e);
        let tangent = sliding_segment(model.wall.law(), segment, &values, speed);
        let [upper, lower] = tangent.map_or([0.0; 2], |tangent| tangent.rubbing);
        rubbing[e] += upper;
        rubbing[e + 1] += lower;
    }
    rubbing
}

impl Chain {
    fn about(model: &Model, equilibrium: &Equilibrium) -> Option<Self> {
        let effects = &model.effects;
        let torque_on_bit = WeakeningTorque::of(&model.scenario, effects);
        let is_excited = effects.contact && effects.friction_torque || torque_on_bit.is_some();
        if !(effects.torsion && is_excited) || model.released_in_motion(0)[THETA_Z] {
            return None;
        }
        // Twist is held at the top, so node i of the mesh is i - 1 here.
        let count = model.node_count() - 1;
        let zero = vec![0.0; count];
        let damping = &model.scenario.damping;
        let rayleigh = if effects.structural_damping {
            [damping.mass_proportional, damping.stiffness_proportional]
        } else {
            [0.0; 2]
        };
        let mut chain = Self {
            inertia: zero.clone(),
            inertia_to_next: zero.clone(),
            stiffness: zero.clone(),
            stiffness_to_next: zero.clone(),
            rubbing: zero,
            rayleigh,
            includes_bit: torque_on_bit.is_some(),
        };
        for (below, element) in model.elements.iter().enumerate() {
            let section = element.beam.section();
            let inertia = section.density * section.polar_moment() * element.beam.length() / 6.0;
            let stiffness = section.torsional_stiffness() / element.beam.length();
            chain.inertia[below] += 2.0 * inertia;
            chain.stiffness[below] += stiffness;
            if let Some(above) = below.checked_sub(1) {
                chain.inertia[above] += 2.0 * inertia;
                chain.stiffness[above] += stiffness;
                chain.inertia_to_next[above] = inertia;
                chain.stiffness_to_next[above] = -stiffness;
            }
        }
        // The chain leaves out the held node at the top.
        chain.rubbing.copy_from_slice(&rubbing(model, equilibrium, model.rotation_speed)[1..]);
        if let (Some(torque), Some(bit)) = (torque_on_bit, chain.rubbing.last_mut()) {
            let [_, slope] = torque.change(0.0);
            *bit -= slope;
        }
        Some(chain)
    }

    fn assessment(&self) -> UndampedTorsion {
        let bound = self.bound();
        let nodes = self.inertia.len();
        let modes = if nodes <= MOST_NODES {
            self.modes()
        } else {
            // No mode above grows.
            let highest = (TAU * bound.highest_hz.unwrap_or(0.0)).powi(2);
            if self.below(highest) * nodes > MOST_VALUES {
                return bound;
            }
            self.modes_below(highest)
        };
        let mesh_hz = self.highest_eigenvalue().sqrt() / TAU;
        let growing = modes.iter().filter(|mode| mode.growth_rate > 0.0);
        let highest = growing.clone().next_back();
        UndampedTorsion {
            modes: nodes,
            growing_modes: Some(growing.count()),
            highest_hz: highest.map(|mode| mode.frequency_hz),
            highest_growth: highest.map(|mode| mode.growth_rate),
            largest_growth: modes
                .iter()
                .map(|mode| mode.growth_rate)
                .reduce(f64::max)
                .unwrap_or(bound.largest_growth),
            mesh_hz,
            up_to_the_mesh: highest.is_some_and(|mode| mode.frequency_hz >= MESH_END * mesh_hz),
            includes_bit: self.includes_bit,
        }
    }

    /// Bounds from the nodes one by one. The inertia matrix is at least half of its diagonal (an element's own is a sixth of
    /// (2 1; 1 2), whose smallest eigenvalue is 1), so no mode is excited by more than the node with most excitation, over half its inertia.
    fn bound(&self) -> UndampedTorsion {
        let [alpha, beta] = self.rayleigh;
        let nodes = || self.inertia.iter().zip(&self.rubbing);
        let fed = nodes().map(|(inertia, rubbing)| -rubbing / (0.5 * inertia)).fold(0.0, f64::max);
        // Gershgorin's bound on the stiffness, which is at most twice its diagonal.
        let ratios = self.stiffness.iter().zip(&self.inertia).map(|(stiffness, inertia)| stiffness / inertia);
        let mesh_hz = (4.0 * ratios.fold(0.0, f64::max)).sqrt() / TAU;
        let surplus = fed - alpha;
        let highest = if surplus <= 0.0 {
            None
        } else if beta > 0.0 {
            Some(((surplus / beta).sqrt() / TAU).min(mesh_hz))
        } else {
            Some(mesh_hz)
        };
        UndampedTorsion {
            modes: self.inertia.len(),
            growing_modes: None,
            highest_hz: highest,
            highest_growth: None,
            largest_growth: 0.5 * surplus,
            mesh_hz,
            up_to_the_mesh: highest.is_some_and(|highest| highest >= MESH_END * mesh_hz),
            includes_bit: self.includes_bit,
        }
    }

    /// All modes by frequency.
    fn modes(&self) -> Vec<TorsionalMode> {
        self.modes_below(self.above_all())
    }

    /// A value above all eigenvalues, at most four times the highest.
    fn above_all(&self) -> f64 {
        let mut above_all = 1.0;
        while self.below(above_all) < self.inertia.len() && above_all < f64::MAX {
            above_all *= 4.0;
        }
        above_all
    }

    fn highest_eigenvalue(&self) -> f64 {
        let mut high = self.above_all();
        let mut low = 0.25 * high;
        while high - low > ENCLOSED * high {
            let middle = 0.5 * (low + high);
            if self.below(middle) == self.inertia.len() { high = middle } else { low = middle }
        }
        0.5 * (low + high)
    }

    /// The modes of eigenvalues below `highest` by frequency: eigenvalues enclosed by Sturm sequences, growth
    /// -phi^T C phi / (2 phi^T M phi) from their shapes.
    fn modes_below(&self, highest: f64) -> Vec<TorsionalMode> {
        let count = self.below(highest);
        let mut modes = Vec::with_capacity(count);
        // Intervals with the numbers of eigenvalues below their ends, the lowest last.
        let mut intervals = vec![(0.0, highest, 0, count)];
        while let Some((low, high, below_low, below_high)) = intervals.pop() {
            if below_low == below_high {
                continue;
            }
            let middle = 0.5 * (low + high);
            if high - low <= ENCLOSED * high || middle <= low || middle >= high {
                // Frequencies closer together than this have one shape.
                modes.extend((below_low..below_high).map(|_| self.mode(middle)));
                continue;
            }
            let below_middle = self.below(middle).clamp(below_low, below_high);
            intervals.push((middle, high, below_middle, below_high));
            intervals.push((low, middle, below_low, below_middle));
        }
        modes
    }

    fn at(&self, value: f64, node: usize) -> f64 {
        self.stiffness[node] - value * self.inertia[node]
    }

    fn to_next(&self, value: f64, node: usize) -> f64 {
        self.stiffness_to_next[node] - value * self.inertia_to_next[node]
    }

    /// Number of eigenvalues below `value`: of negative pivots of K - value M (Sylvester).
    fn below(&self, value: f64) -> usize {
        let (mut pivot, mut coupling, mut negative) = (1.0, 0.0, 0);
        for node in 0..self.inertia.len() {
            pivot = no_zero(self.at(value, node) - coupling * coupling / pivot);
            negative += usize::from(pivot < 0.0);
            coupling = self.to_next(value, node);
        }
        negative
    }

    /// The mode of an eigenvalue: its shape from the elimination downwards and upwards, which meet where the pivot is smallest
    /// (Fernando 1997).
    fn mode(&self, value: f64) -> TorsionalMode {
        let count = self.inertia.len();
        let (mut down, mut up) = (vec![0.0; count], vec![0.0; count]);
        for node in 0..count {
            let above =
                node.checked_sub(1).map_or(0.0, |above| self.to_next(value, above).powi(2) / down[above]);
            down[node] = no_zero(self.at(value, node) - above);
        }
        for node in (0..count).rev() {
            let below = up.get(node + 1).map_or(0.0, |below| self.to_next(value, node).powi(2) / below);
            up[node] = no_zero(self.at(value, node) - below);
        }
        let pivot = |node: usize| (down[node] + up[node] - self.at(value, node)).abs() / self.inertia[node];
        let meeting = (0..count).min_by(|&a, &b| pivot(a).total_cmp(&pivot(b))).unwrap_or(0);
        let mut shape = vec![0.0; count];
        shape[meeting] = 1.0;
        for node in (0..meeting).rev() {
            shape[node] = -self.to_next(value, node) / down[node] * shape[node + 1];
        }
        for node in meeting + 1..count {
            shape[node] = -self.to_next(value, node - 1) / up[node] * shape[node - 1];
        }
        let (mut inertia, mut rubbing) = (0.0, 0.0);
        for node in 0..count {
            let next = shape.get(node + 1).copied().unwrap_or(0.0);
            inertia +=
                shape[node] * (self.inertia[node] * shape[node] + 2.0 * self.inertia_to_next[node] * next);
            rubbing += self.rubbing[node] * shape[node] * shape[node];
        }
        let [alpha, beta] = self.rayleigh;
        TorsionalMode {
            frequency_hz: value.sqrt() / TAU,
            growth_rate: -0.5 * (alpha + beta * value + rubbing / inertia),
        }
    }
}

/// A pivot that may be divided by.
fn no_zero(pivot: f64) -> f64 {
    if pivot == 0.0 { f64::MIN_POSITIVE.sqrt() } else { pivot }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Scenario, preset};

    use super::*;

    /// A uniform shaft of 40 elements, clamped above.
    fn shaft(rubbing: f64, rayleigh: [f64; 2]) -> Chain {
        let (count, inertia, stiffness) = (40, 0.07, 2e6);
        let mut chain = Chain {
            inertia: vec![4.0 * inertia; count],
            inertia_to_next: vec![inertia; count],
            stiffness: vec![2.0 * stiffness; count],
            stiffness_to_next: vec![-stiffness; count],
            rubbing: vec![rubbing; count],
            rayleigh,
            includes_bit: false,
        };
        (chain.inertia[count - 1], chain.stiffness[count - 1]) = (2.0 * inertia, stiffness);
        chain
    }

    #[test]
    fn uniform_shaft_has_the_frequencies_of_its_linear_elements() {
        // sin(k x) with k = (n - 1/2) pi / L satisfies the equations of the nodes: omega^2 = K / J (1 - cos k h) / (2 + cos k h).
        let (alpha, beta) = (0.03, 2e-6);
        let modes = shaft(0.0, [alpha, beta]).modes();
        assert_eq!(modes.len(), 40);
        for (n, mode) in modes.iter().enumerate() {
            let phase = (n as f64 + 0.5) * std::f64::consts::PI / 40.0;
            let square = 2e6 / 0.07 * (1.0 - phase.cos()) / (2.0 + phase.cos());
            assert!((mode.frequency_hz * TAU / square.sqrt() - 1.0).abs() < ENCLOSED, "{n}: {mode:?}");
            let growth = -0.5 * (alpha + beta * square);
            assert!(
                (mode.growth_rate / growth - 1.0).abs() < 10.0 * ENCLOSED,
                "{n}: {mode:?} against {growth}"
            );
        }
    }

    #[test]
    fn dampers_at_the_nodes_act_as_their_share_of_a_modes_energy() {
        // With d at every node and d / 2 at the end, phi^T D phi over phi^T M phi of sin(k x) is d / (2 J (2 + cos k h)).
        let mut chain = shaft(-0.5, [0.0; 2]);
        *chain.rubbing.last_mut().unwrap() = -0.25;
        for (n, mode) in chain.modes().iter().enumerate() {
            let phase = (n as f64 + 0.5) * std::f64::consts::PI / 40.0;
            let growth = 0.5 * 0.5 / (2.0 * 0.07 * (2.0 + phase.cos()));
            assert!((mode.growth_rate / growth - 1.0).abs() < 1e-6, "{n}: {mode:?} against {growth}");
        }
    }

    #[test]
    fn growth_does_not_depend_on_the_number_of_nodes() {
        // Elements a quarter as long: 1184 of them. Modes that decay in any case are not computed.
        let mut scenario = preset("paper-200m-damped").unwrap();
        let found = |scenario: &Scenario| {
            let model = Model::new(scenario).unwrap();
            UndampedTorsion::about(&model, &Equilibrium::find(&model).unwrap()).unwrap()
        };
        let coarse = found(&scenario);
        scenario.scale_mesh(0.25);
        let fine = found(&scenario);
        assert!(coarse.modes < MOST_NODES && fine.modes > MOST_NODES);
        assert_eq!(fine.growing_modes, coarse.growing_modes);
        let [coarse, fine] = [coarse, fine].map(|found| found.highest_hz.unwrap());
        assert!((fine / coarse - 1.0).abs() < 1e-3, "{fine} and {coarse} Hz");
    }

    #[test]
    fn bounds_of_long_strings_hold() {
        for beta in [0.0, 1e-7, 3e-5] {
            let mut scenario = preset("paper-200m").unwrap();
            scenario.damping.stiffness_proportional = beta;
            let model = Model::new(&scenario).unwrap();
            let chain = Chain::about(&model, &Equilibrium::find(&model).unwrap()).unwrap();
            let (found, bound) = (chain.assessment(), chain.bound());
            assert!(
                bound.largest_growth >= found.largest_growth && bound.mesh_hz >= found.mesh_hz,
                "{bound:?}"
            );
            assert!(bound.highest_hz.unwrap() >= found.highest_hz.unwrap(), "{bound:?} of {found:?}");
            assert_eq!(bound.up_to_the_mesh, found.up_to_the_mesh, "{bound:?} of {found:?}");
        }
    }

    #[test]
    fn steps_that_do_not_resolve_a_growing_mode_have_a_warning() {
        let torsion = |highest, mesh| UndampedTorsion {
            modes: 10,
            growing_modes: Some(3),
            highest_hz: highest,
            highest_growth: highest.map(|_| 0.1),
            largest_growth: 0.2,
            mesh_hz: mesh,
            up_to_the_mesh: highest == Some(mesh),
            includes_bit: false,
        };
        assert_eq!(torsion(None, 4e3).warning(40.0), None);
        assert_eq!(torsion(Some(12.9), 4e3).warning(40.0), None);
        assert!(torsion(Some(95.7), 4e3).warning(40.0).unwrap().contains("up to 96 Hz"));
        assert_eq!(torsion(Some(95.7), 4e3).warning(160.0), None);
        assert!(torsion(Some(4e3), 4e3).warning(1e6).unwrap().contains("where the mesh ends"));
    }
}
