//! Forces that shake the string at one place, harmonic or random in a band of frequencies.
//!
//! A harmonic force is A cos(2 pi f t + phase). A random one is the sum of [`COMPONENTS`] cosines of equal power in equal parts of its band, with frequencies and
//! phases drawn from its seed (docs/model/drive.md).

use std::f64::consts::TAU;
use std::sync::Arc;

use drillsweep_scenario::{ExcitationDirection, ExcitingForce};

use crate::force::nodal::{At, Dependence, ForceContext, NodalForce};
use crate::force::term::{Account, Decision, EffectContext, Term, no, yes};
use crate::math::dof::{DOFS, THETA_Z, U, V, W};
use crate::string::nearest_node;

pub(crate) const TERM: Term = Term::new(decide);

/// Work of the excitations.
pub(crate) const WORK: Account =
    Account::given("work_excitation", |booked| booked.by_force("work_excitation"));

/// Cosines of a random force.
const COMPONENTS: u32 = 64;

/// Steps in a period of the highest frequency of an excitation.
const STEPS_OF_A_PERIOD: f64 = 20.0;

fn decide(context: &EffectContext<'_>) -> Decision {
    let is_force = |force: &ExcitingForce| amplitude(force) != 0.0;
    if context.scenario.excitation.iter().any(is_force) {
        yes("forces excite the string")
    } else {
        no("no force excites the string")
    }
}

fn amplitude(force: &ExcitingForce) -> f64 {
    force.force.or(force.torque).unwrap_or(0.0)
}

/// The excitations of a scenario.
pub(super) fn force(context: &ForceContext<'_>) -> Option<Arc<dyn NodalForce>> {
    let forces = context.scenario.excitation.iter().filter(|_| context.effects.excitation);
    let bit = context.nodes.last()?.measured_depth;
    let mut nodes = Vec::new();
    let mut signals = Vec::new();
    for force in forces.filter(|force| amplitude(force) != 0.0) {
        let node = nearest_node(context.nodes, force.depth(bit));
        nodes.push(node);
        signals.push(Signal::new(force, context.drive.nominal_speed(), context.frames[node].low_side_angle));
    }
    (!nodes.is_empty()).then(|| Arc::new(Excitations { nodes, signals }) as Arc<dyn NodalForce>)
}

/// Forces over time, each at a node of its own.
#[derive(Debug)]
struct Excitations {
    nodes: Vec<usize>,
    signals: Vec<Signal>,
}

/// A force over time.
#[derive(Debug, Clone, PartialEq)]
struct Signal {
    /// Force or torque along each degree of freedom for a signal of one \[N, N m\].
    along: [f64; DOFS],
    /// The same of a signal that is a quarter of a period behind.
    behind: [f64; DOFS],
    /// Angular frequency \[rad/s\] and phase \[rad\] of each cosine; their amplitude is one.
    cosines: Vec<[f64; 2]>,
}

impl Signal {
    /// The signal of a force at a node whose low side lies at an angle \[rad\] from e1, with the nominal speed of rotation \[rad/s\].
    fn new(force: &ExcitingForce, nominal_speed: f64, low_side: f64) -> Self {
        let phase = force.phase_deg.to_radians();
        let frequency = force.frequency_hz.unwrap_or(0.0);
        let (cosines, amplitude) = match (force.band_to_hz, force.per_revolution) {
            (Some(to), _) => {
                let share = (2.0 / f64::from(COMPONENTS)).sqrt();
                (random_cosines(force.seed, [frequency, to]), share * amplitude(force))
            }
            (None, Some(cycles)) => (vec![[cycles * nominal_speed, phase]], amplitude(force)),
            (None, None) => (vec![[TAU * frequency, phase]], amplitude(force)),
        };
        let (sine, cosine) = low_side.sin_cos();
        let (mut along, mut behind) = ([0.0; DOFS], [0.0; DOFS]);
        match force.direction {
            ExcitationDirection::Axial => along[W] = amplitude,
            ExcitationDirection::Torsional => along[THETA_Z] = amplitude,
            ExcitationDirection::LateralLowSide => {
                (along[U], along[V]) = (amplitude * cosine, amplitude * sine);
            }
            ExcitationDirection::LateralAcross => {
                (along[U], along[V]) = (-amplitude * sine, amplitude * cosine);
            }
            ExcitationDirection::LateralRotating => {
                (along[U], along[V]) = (amplitude * cosine, amplitude * sine);
                (behind[U], behind[V]) = (-amplitude * sine, amplitude * cosine);
            }
        }
        Self { along, behind, cosines }
    }

    fn force(&self, time: f64) -> [f64; DOFS] {
        let (mut signal, mut quarter) = (0.0, 0.0);
        for [omega, phase] in &self.cosines {
            let (sine, cosine) = (omega * time + phase).sin_cos();
            signal += cosine;
            quarter += sine;
        }
        std::array::from_fn(|dof| signal * self.along[dof] + quarter * self.behind[dof])
    }

    fn highest_hz(&self) -> f64 {
        self.cosines.iter().map(|[omega, _]| omega.abs() / TAU).fold(0.0, f64::max)
    }
}

/// Angular frequency and phase of a random force's cosines, one in each of equal parts of a band \[Hz\].
fn random_cosines(seed: u32, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let width = (to - from) / f64::from(COMPONENTS);
    let cosine = |part: u32| {
        let place = 2 * u64::from(part);
        let frequency = from + width * (f64::from(part) + uniform(seed, place));
        [TAU * frequency, TAU * uniform(seed, place + 1)]
    };
    (0..COMPONENTS).map(cosine).collect()
}

/// Number `place` of a sequence of numbers in 0 to 1, drawn from a seed (SplitMix64: Steele, Lea and Flood 2014).
fn uniform(seed: u32, place: u64) -> f64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    let mut z =
        u64::from(seed).wrapping_mul(0xd129_0d3b_3a9c_6e4b).wrapping_add((place + 1).wrapping_mul(GOLDEN));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    (z >> 11) as f64 / (1_u64 << 53) as f64
}

impl NodalForce for Excitations {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn dependence(&self) -> Dependence {
        Dependence::Time
    }

    fn entry(&self) -> Option<&'static str> {
        Some(WORK.name)
    }

    fn forces(&self, at: &At<'_>, out: &mut [[f64; DOFS]]) {
        for (out, signal) in out.iter_mut().zip(&self.signals) {
            *out = signal.force(at.time);
        }
    }

    fn longest_step(&self) -> f64 {
        let highest = self.signals.iter().map(Signal::highest_hz).fold(0.0, f64::max);
        1.0 / (STEPS_OF_A_PERIOD * highest)
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::ExcitationDirection::{Axial, LateralAcross, LateralLowSide, LateralRotating};

    use super::*;

    fn force(direction: ExcitationDirection) -> ExcitingForce {
        ExcitingForce {
            measured_depth: None,
            above_bit: Some(0.0),
            section: None,
            above_end: None,
            direction,
            force: Some(100.0),
            torque: None,
            frequency_hz: Some(2.0),
            per_revolution: None,
            phase_deg: 0.0,
            band_to_hz: None,
            seed: 0,
        }
    }

    #[test]
    fn a_lateral_force_keeps_to_its_direction_and_a_turning_one_goes_round() {
        let low_side = 0.3_f64;
        let at = |direction, time: f64| {
            let [u, v, ..] = Signal::new(&force(direction), 0.0, low_side).force(time);
            [u.hypot(v), v.atan2(u)]
        };
        let same = |[size, angle]: [f64; 2], wanted: [f64; 2]| {
            assert!((size - wanted[0]).abs() < 1e-9, "{size}, {wanted:?}");
            assert!(
                (angle - wanted[1]).sin().abs() < 1e-9 && (angle - wanted[1]).cos() > 0.0,
                "{angle}, {wanted:?}"
            );
        };
        same(at(LateralLowSide, 0.0), [100.0, low_side]);
        same(at(LateralAcross, 0.0), [100.0, low_side + 0.25 * TAU]);
        // A tenth of a period of half a second.
        same(at(LateralLowSide, 0.05), [100.0 * (0.1 * TAU).cos(), low_side]);
        same(at(LateralRotating, 0.05), [100.0, low_side + 0.1 * TAU]);
    }

    #[test]
    fn cycles_in_a_revolution_follow_the_nominal_speed() {
        let of_cycles = ExcitingForce { frequency_hz: None, per_revolution: Some(3.0), ..force(Axial) };
        // 40 rpm are two thirds of a revolution a second.
        let signal = Signal::new(&of_cycles, TAU * 40.0 / 60.0, 0.0);
        for time in [0.0, 0.013, 1.7] {
            let plain = Signal::new(&force(Axial), 0.0, 0.0).force(time)[W];
            assert!((signal.force(time)[W] - plain).abs() < 1e-9);
        }
        assert!((signal.highest_hz() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_random_force_has_its_mean_square_in_its_band_and_is_that_of_its_seed() {
        let signal =
            |seed| Signal::new(&ExcitingForce { band_to_hz: Some(6.0), seed, ..force(Axial) }, 0.0, 0.0);
        let random = signal(7);
        // Cosines a sixteenth of a hertz apart are orthogonal over 1,000 s to a few per cent.
        let mean_square = |signal: &Signal| {
            let samples = 40_000;
            let square = |i: i32| signal.force(f64::from(i) / 40.0)[W].powi(2);
            (0..samples).map(square).sum::<f64>() / f64::from(samples)
        };
        assert!((mean_square(&random).sqrt() / 100.0 - 1.0).abs() < 0.02, "{}", mean_square(&random).sqrt());
        for (part, [omega, _]) in random.cosines.iter().enumerate() {
            let from = 2.0 + 4.0 * part as f64 / 64.0;
            assert!((from..=from + 4.0 / 64.0).contains(&(omega / TAU)));
        }
        assert_eq!(random, signal(7));
        assert_ne!(random.cosines, signal(8).cosines);
        // Phases of one seed are spread evenly: the mean of their directions is that of 64 random ones.
        let sum = |of: fn(f64) -> f64| random.cosines.iter().map(|[_, phase]| of(*phase)).sum::<f64>();
        assert!(sum(f64::cos).hypot(sum(f64::sin)) < 3.0 * 8.0);
    }
}
