//! Sources of vibration drawn at random: law of the bit, top drive, excitations. Those of scenario i of a seed are always the same.

use drillsweep_scenario::{
    Bit, BitLaw, ExcitationDirection, ExcitingForce, Scenario, TopDrive, TopDriveKind, Tuning,
};

use crate::random_scenario::Draw;

/// Mixed into the seed, so that sources do not follow the scenario's own numbers.
const OWN_SEQUENCE: u64 = 0x736f_7572_6365;

/// Gives a random scenario sources of vibration, most of them violent.
pub(crate) fn add_sources(seed: u64, index: u64, scenario: &mut Scenario) {
    let mut draw = Draw::new(seed ^ OWN_SEQUENCE, index);
    let fastest = scenario.operation.rotation_speed_rpm.abs() * std::f64::consts::PI / 30.0;
    scenario.bit = Bit {
        law: BitLaw::VelocityWeakening,
        static_ratio: if draw.chance(0.1) { 1.0 } else { draw.log(1.0, 10.0) },
        weakening_speed: draw.log(0.05, 1e3),
        regularisation_speed: draw.log(1e-3, 10.0).min(0.9 * fastest),
        aggressiveness: draw.chance(0.3).then(|| draw.log(1e-2, 5.0)),
        ..Bit::default()
    };
    if scenario.bit.aggressiveness.is_some() {
        scenario.operation.torque_on_bit = 0.0;
    }
    if fastest == 0.0 {
        scenario.bit = Bit { law: BitLaw::Constant, aggressiveness: None, ..Bit::default() };
    }
    scenario.top_drive = TopDrive {
        kind: [TopDriveKind::ImposedSpeed, TopDriveKind::SpeedControl, TopDriveKind::ZTorque]
            [draw.below(3) as usize],
        tuning: if draw.chance(0.5) { Tuning::Soft } else { Tuning::Stiff },
        gain: draw.log(1e-2, 100.0),
        frequency_hz: draw.chance(0.3).then(|| draw.log(1e-3, 10.0)),
        inertia: draw.or_zero(0.2, 1.0, 1e5),
        inertia_compensation: if draw.chance(0.2) { 1.0 } else { draw.between(0.0, 1.0) },
        factor: draw.or_zero(0.2, 0.1, 10.0),
        time_constant: draw.log(0.01, 1000.0),
    };
    let count = draw.below(4);
    scenario.excitation = (0..count).map(|_| draw_force(&mut draw, fastest)).collect();
}

fn draw_force(draw: &mut Draw, fastest: f64) -> ExcitingForce {
    use ExcitationDirection::{Axial, LateralAcross, LateralLowSide, LateralRotating, Torsional};
    let direction =
        [Axial, LateralAcross, LateralLowSide, LateralRotating, Torsional][draw.below(5) as usize];
    let is_torsional = direction == Torsional;
    let amplitude = draw.or_zero(0.1, 1.0, 1e6);
    let per_revolution = (fastest > 0.0 && draw.chance(0.3)).then(|| draw.log(0.1, 10.0));
    let frequency_hz = draw.log(0.01, 250.0);
    let is_random = draw.chance(0.3) && per_revolution.is_none() && direction != LateralRotating;
    ExcitingForce {
        measured_depth: None,
        above_bit: Some(0.0),
        section: None,
        above_end: None,
        direction,
        force: (!is_torsional).then_some(amplitude),
        torque: is_torsional.then_some(amplitude),
        frequency_hz: per_revolution.is_none().then_some(frequency_hz),
        per_revolution,
        phase_deg: draw.between(-360.0, 360.0),
        band_to_hz: is_random.then_some(2.0 * frequency_hz),
        seed: draw.below(1000) as u32,
    }
}
