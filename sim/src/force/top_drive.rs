//! Top drive with inertia under proportional-integral control of its speed.
//!
//! In the frame that turns at the set speed the torque of the motor is that of the equilibrium less K_p d theta_z/dt + K_i theta_z of the top: a dashpot and a
//! torsional spring, which are entries of the damping and stiffness matrices, with the inertia of the drive in the mass matrix. Z-torque adds to the set speed
//! -(f / Z) y of the measured torque T_s = -G I_p d theta_z/ds less its lasting part, dy/dt = dT_s/dt - y / tau: a torque -(f / Z) (K_p y + K_i int y dt) on the top
//! (docs/model/drive.md).

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use drillsweep_scenario::{ActiveEffects, Scenario, TopDriveKind, Tuning};

use crate::force::nodal::{At, Dependence, ForceContext, NodalForce};
use crate::force::term::{Account, Decision, EffectContext, Term, no, yes};
use crate::math::dof::{DOFS, THETA_Z};
use crate::string::beam::BeamSection;
use crate::string::{UniformPart, stretches};

pub(crate) const TERM: Term = Term::new(decide);

/// Work of the drive on the twist of the top, but for that of its spring.
pub(crate) const WORK: Account = Account::given("work_drive", |booked| booked.by_force("work_drive"));

/// Damping of the stiff tuning in impedances of the top pipe.
const STIFF_DAMPING: f64 = 50.0;

/// Stiffness of the stiff tuning over the inertia \[1/s2\].
const STIFF_STIFFNESS: f64 = 5.0;

fn decide(context: &EffectContext<'_>) -> Decision {
    match context.scenario.top_drive.kind {
        TopDriveKind::ImposedSpeed => no("the speed of the top is imposed"),
        TopDriveKind::SpeedControl | TopDriveKind::ZTorque => {
            yes("the top drive yields to the torque of the string")
        }
    }
}

/// Control of the speed at the top: entries at the twist of the first node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SpeedControl {
    /// J less its compensated part \[kg m2\].
    pub(crate) inertia: f64,
    /// K_p \[N m s\].
    pub(crate) damping: f64,
    /// K_i \[N m\].
    pub(crate) stiffness: f64,
}

impl SpeedControl {
    /// Power of the damping \[W\] at a rate of twist of the top \[rad/s\].
    pub(crate) fn power(&self, rate: f64) -> f64 {
        -self.damping * rate * rate
    }

    /// The control of a scenario, if its top yields.
    pub(crate) fn of(scenario: &Scenario, effects: &ActiveEffects) -> Option<Self> {
        let (string, drive) = (&scenario.string, &scenario.top_drive);
        let yields = effects.top_drive && drive.kind != TopDriveKind::ImposedSpeed;
        let section = string.sections.first().filter(|_| yields)?;
        let tuning = if drive.kind == TopDriveKind::ZTorque { Tuning::Stiff } else { drive.tuning };
        let impedance = BeamSection::of(&string.body(section)).torsional_impedance();
        let inertia = (1.0 - drive.inertia_compensation) * drive.inertia;
        let (damping, stiffness) = match tuning {
            Tuning::Stiff => (STIFF_DAMPING * impedance, STIFF_STIFFNESS * drive.inertia),
            Tuning::Soft => {
                let frequency = drive.frequency_hz.unwrap_or_else(|| lowest_frequency_hz(scenario));
                (drive.gain * impedance, (TAU * frequency).powi(2) * inertia)
            }
        };
        Some(Self { inertia, damping, stiffness })
    }
}

/// Place of the filtered torque y \[N m\] among the unknowns.
const FILTERED: usize = 0;

/// Place of its integral over time \[N m s\].
const INTEGRAL: usize = 1;

/// The torque by which Z-torque control changes that of the speed control.
pub(super) fn force(context: &ForceContext<'_>) -> Option<Arc<dyn NodalForce>> {
    let scenario = context.scenario;
    let takes_part = scenario.top_drive.kind == TopDriveKind::ZTorque && context.effects.torsion;
    let control = SpeedControl::of(scenario, context.effects).filter(|_| takes_part)?;
    let [top, below, ..] = context.nodes else { return None };
    let pipe = BeamSection::of(&scenario.string.body(scenario.string.sections.first()?));
    let first = BeamSection::of(&stretches(scenario).ok()?.first()?.tube);
    Some(Arc::new(MeasuredTorque {
        nodes: [0, 1],
        stiffness: first.torsional_stiffness() / (below.measured_depth - top.measured_depth),
        per_torque: scenario.top_drive.factor / pipe.torsional_impedance(),
        time_constant: scenario.top_drive.time_constant,
        control,
    }))
}

/// Set-point of a speed control that follows the torque of the first element.
#[derive(Debug)]
struct MeasuredTorque {
    nodes: [usize; 2],
    /// G I_p / L of the first element \[N m/rad\].
    stiffness: f64,
    /// f / Z \[rad/(N m s)\].
    per_torque: f64,
    /// tau \[s\].
    time_constant: f64,
    control: SpeedControl,
}

impl MeasuredTorque {
    /// Rate of the measured torque \[N m/s\].
    fn torque_rate(&self, at: &At<'_>) -> f64 {
        let [top, below] = self.nodes.map(|node| (at.motion)(node).velocity[THETA_Z]);
        self.stiffness * (top - below)
    }
}

impl NodalForce for MeasuredTorque {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn dependence(&self) -> Dependence {
        Dependence::Motion
    }

    fn entry(&self) -> Option<&'static str> {
        Some(WORK.name)
    }

    fn forces(&self, at: &At<'_>, out: &mut [[f64; DOFS]]) {
        let SpeedControl { damping, stiffness, .. } = self.control;
        let torque = damping * at.unknowns[FILTERED] + stiffness * at.unknowns[INTEGRAL];
        out[0][THETA_Z] = -self.per_torque * torque;
    }

    fn longest_step(&self) -> f64 {
        self.time_constant
    }

    fn unknowns(&self) -> Vec<f64> {
        vec![0.0; 2]
    }

    fn rates(&self, at: &At<'_>, out: &mut [f64]) {
        out[FILTERED] = self.torque_rate(at) - at.unknowns[FILTERED] / self.time_constant;
        out[INTEGRAL] = at.unknowns[FILTERED];
    }

    fn solve_unknowns(&self, at: &At<'_>, base: &[f64], factor: f64, out: &mut [f64]) {
        out[FILTERED] =
            (base[FILTERED] + factor * self.torque_rate(at)) / (1.0 + factor / self.time_constant);
        out[INTEGRAL] = base[INTEGRAL] + factor * out[FILTERED];
    }
}

/// Steps in which the angular frequency is searched, in half periods of a wave's travel through the string.
const SEARCH_STEPS: u32 = 64;

/// Bisections of a step of the search: to rounding.
const BISECTIONS: u32 = 60;

/// Lowest torsional frequency of the string held at its top \[Hz\]: of its bodies and tool joints as uniform shafts, exactly.
fn lowest_frequency_hz(scenario: &Scenario) -> f64 {
    // A scenario without such parts has no model.
    let parts: Vec<Shaft> = stretches(scenario).unwrap_or_default().iter().map(Shaft::of).collect();
    let travel: f64 = parts.iter().map(|shaft| shaft.travel_time).sum();
    let step = PI / travel / f64::from(SEARCH_STEPS);
    let has_passed = |omega: f64| twist_at_top(&parts, omega) <= 0.0;
    let Some(high) =
        (1..=4 * SEARCH_STEPS).map(|count| f64::from(count) * step).find(|omega| has_passed(*omega))
    else {
        return FRAC_PI_2 / travel / TAU;
    };
    let mut bracket = [high - step, high];
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (bracket[0] + bracket[1]);
        bracket[usize::from(has_passed(middle))] = middle;
    }
    0.5 * (bracket[0] + bracket[1]) / TAU
}

/// A uniform part of the string in torsion.
struct Shaft {
    /// Time of a wave through it \[s\].
    travel_time: f64,
    /// I_p sqrt(rho G) \[N m s\].
    impedance: f64,
}

impl Shaft {
    fn of(part: &UniformPart) -> Self {
        let section = BeamSection::of(&part.tube);
        Self {
            travel_time: (part.bottom - part.top) / section.torsional_wave_speed(),
            impedance: section.torsional_impedance(),
        }
    }
}

/// Twist of the top of a chain of shafts, from the top down, that oscillates with an angular frequency \[rad/s\] and a unit twist of its free end.
fn twist_at_top(shafts: &[Shaft], omega: f64) -> f64 {
    // Twist, and torque over the frequency.
    let through = |[twist, torque]: [f64; 2], shaft: &Shaft| {
        let (sine, cosine) = (omega * shaft.travel_time).sin_cos();
        [twist * cosine + torque / shaft.impedance * sine, torque * cosine - shaft.impedance * twist * sine]
    };
    shafts.iter().rev().fold([1.0, 0.0], through)[0]
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{TopDrive, preset};
    use nalgebra::Complex;
    use serde_json::json;

    use super::*;

    /// 850 m of 127/108 mm above 150 m of 159/71 mm, of the paper's steel, with a soft drive.
    fn string(drive: TopDrive) -> Scenario {
        let sections = json!([
            { "kind": "drillpipe", "length": 850.0, "outer_diameter": 0.127, "inner_diameter": 0.108 },
            { "kind": "collar", "length": 150.0, "outer_diameter": 0.159, "inner_diameter": 0.071 },
        ]);
        let mut scenario = preset("paper-200m").unwrap().with("string.sections", sections).unwrap();
        scenario.top_drive = TopDrive { kind: TopDriveKind::SpeedControl, tuning: Tuning::Soft, ..drive };
        scenario
    }

    #[test]
    fn a_soft_drive_is_tuned_to_the_string_and_reflects_what_it_does_not_absorb() {
        let scenario = string(TopDrive::default());
        let f1 = lowest_frequency_hz(&scenario);
        // An independent program has 0.53012 Hz with 23 elements, which raise it by some (omega h / c)^2 / 24.
        assert!((f1 / 0.53012 - 1.0).abs() < 1e-4, "{f1}");
        let [pipe, collars] =
            [0, 1].map(|i| BeamSection::of(&scenario.string.body(&scenario.string.sections[i])));
        let [of_pipe, of_collars] = [(pipe, 850.0), (collars, 150.0)]
            .map(|(shaft, length)| (TAU * f1 * length / shaft.torsional_wave_speed()).tan());
        let impedance = pipe.torsional_impedance();
        assert!((of_pipe * of_collars * collars.torsional_impedance() / impedance - 1.0).abs() < 1e-9);
        assert!((impedance - 302.574).abs() < 1e-3, "{impedance}");
        // |(Z - Z_d) / (Z + Z_d)| with Z_d = J s + K_p + K_i / s, published for gain 1.
        for (compensation, wanted) in [
            (0.0, [0.99913, 0.99045, 0.0, 0.99045, 0.99913]),
            (0.9, [0.92275, 0.58340, 0.0, 0.58340, 0.92275]),
        ] {
            let drive = TopDrive { gain: 1.0, inertia_compensation: compensation, ..TopDrive::default() };
            let effects = ActiveEffects::ALL;
            let control = SpeedControl::of(&string(drive), &effects).unwrap();
            for (times, wanted) in [0.5, 0.8, 1.0, 1.25, 2.0].into_iter().zip(wanted) {
                let s = Complex::new(0.0, TAU * f1 * times);
                let of_drive = s * control.inertia + control.damping + control.stiffness / s;
                let reflection = ((impedance - of_drive) / (impedance + of_drive)).norm();
                // The published ones are of 0.53012 Hz.
                assert!((reflection - wanted).abs() < 5e-5, "{compensation}, {times} f1: {reflection}");
            }
        }
        assert_eq!(
            SpeedControl::of(
                &string(TopDrive::default()),
                &ActiveEffects { top_drive: false, ..ActiveEffects::ALL }
            ),
            None
        );
    }

    #[test]
    fn the_lowest_frequency_of_a_uniform_string_is_that_of_a_quarter_wave() {
        let mut scenario = string(TopDrive::default());
        scenario.string.sections.truncate(1);
        let pipe = BeamSection::of(&scenario.string.body(&scenario.string.sections[0]));
        let wanted = pipe.torsional_wave_speed() / (4.0 * 850.0);
        assert!((lowest_frequency_hz(&scenario) / wanted - 1.0).abs() < 1e-12);
    }
}
