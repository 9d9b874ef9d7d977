//! Rules of bit, top drive and excitation.

use std::ops::RangeInclusive;

use drillsweep_scenario::{
    BitLaw, ExcitationDirection, ExcitingForce, Operation, Scenario, TopCondition, TopDrive, TopDriveKind,
    Tuning,
};

use super::report::Report;
use super::string::{MOST_EXCITATIONS, has_place};

/// Largest aggressiveness of a bit; fixed cutters in soft rock reach 2.
const LARGEST_AGGRESSIVENESS: f64 = 10.0;

/// Static ratios of torque on bit from a constant torque to beyond all published fits.
const STATIC_RATIOS: RangeInclusive<f64> = 1.0..=10.0;

/// Largest speed over which torque on bit falls \[rad/s\]: torque is as good as constant.
const LARGEST_WEAKENING_SPEED: f64 = 1000.0;

/// Largest speed up to which torque on bit rises \[rad/s\], 95 rpm.
const LARGEST_REGULARISATION_SPEED: f64 = 10.0;

/// Largest radius of a bit \[m\], half of the widest hole.
const LARGEST_BIT_RADIUS: f64 = 2.5;

/// Specific energies of rocks \[Pa\], from below all soils to beyond the hardest.
const SPECIFIC_ENERGIES: RangeInclusive<f64> = 1e5..=1e10;

/// Inclinations of the cutting force.
const INCLINATIONS: RangeInclusive<f64> = 0.01..=10.0;

/// Contact stresses of wear flats \[Pa\].
const CONTACT_STRESSES: RangeInclusive<f64> = 0.0..=1e10;

/// Lengths of the wear flats of all blades \[m\].
const WEAR_LENGTHS: RangeInclusive<f64> = 0.0..=0.5;

/// Products of friction coefficient and geometry of the wear flats.
const FRICTION_GEOMETRIES: RangeInclusive<f64> = 0.0..=10.0;

/// Numbers of blades.
const BLADES: RangeInclusive<u32> = 1..=20;

/// Largest damping of a drive in impedances of the top pipe.
const LARGEST_GAIN: f64 = 100.0;

/// Highest frequency to which a drive is tuned \[Hz\]: strings of 80 m have 10 Hz.
const HIGHEST_TUNING: f64 = 10.0;

/// Largest inertia of a drive \[kg m2\], thirty times that of the largest.
const LARGEST_INERTIA: f64 = 1e5;

/// Largest impedance factor of Z-torque.
const LARGEST_FACTOR: f64 = 10.0;

/// Time constants of the torque filter of Z-torque \[s\].
const TIME_CONSTANTS: RangeInclusive<f64> = 0.01..=1000.0;

/// Largest amplitude of a force \[N\].
const LARGEST_FORCE: f64 = 1e8;

/// Largest amplitude of a torque \[N m\].
const LARGEST_TORQUE: f64 = 1e7;

/// Highest frequency of an excitation \[Hz\]; higher ones need steps below 0.1 ms and elements of some decimetres.
const HIGHEST_FREQUENCY: f64 = 500.0;

/// Largest number of cycles in a revolution.
const MOST_CYCLES: f64 = 100.0;

pub(super) fn check(report: &mut Report, scenario: &Scenario) {
    check_bit(report, scenario);
    check_top_drive(report, &scenario.top_drive, &scenario.operation);
    report.require(
        scenario.top_drive.kind != TopDriveKind::ZTorque || !scenario.recording.stability,
        "recording.stability",
        "true",
        "modes do not hold the torque filter of z_torque: with it `recording.stability` must be false",
    );
    let sections = scenario.string.named_sections();
    for (i, force) in scenario.excitation.iter().enumerate().take(MOST_EXCITATIONS) {
        let path = format!("excitation[{i}]");
        has_place(report, &path, force.place(), &sections);
        check_excitation(report, &path, force, scenario);
    }
}

fn check_bit(report: &mut Report, scenario: &Scenario) {
    let Scenario { bit, operation, .. } = scenario;
    if let Some(aggressiveness) = bit.aggressiveness {
        report.number(
            aggressiveness,
            "bit.aggressiveness",
            |value| (0.0..=LARGEST_AGGRESSIVENESS).contains(&value),
            format!("must be 0 to {LARGEST_AGGRESSIVENESS}"),
        );
        report.number(
            operation.torque_on_bit,
            "operation.torque_on_bit",
            |torque| torque == 0.0,
            "follows from bit.aggressiveness and operation.weight_on_bit: give 0",
        );
    }
    check_cut(report, scenario);
    let (least, most) = STATIC_RATIOS.into_inner();
    report.number(
        bit.static_ratio,
        "bit.static_ratio",
        |ratio| STATIC_RATIOS.contains(&ratio),
        format!("must be {least} to {most}"),
    );
    report.number(
        bit.weakening_speed,
        "bit.weakening_speed",
        |speed| speed > 0.0 && speed <= LARGEST_WEAKENING_SPEED,
        format!("must be greater than 0 and at most {LARGEST_WEAKENING_SPEED} rad/s (60 rpm is 6.28 rad/s)"),
    );
    let regularisation = bit.regularisation_speed;
    report.number(
        regularisation,
        "bit.regularisation_speed",
        |speed| speed > 0.0 && speed <= LARGEST_REGULARISATION_SPEED,
        format!(
            "must be greater than 0 and at most {LARGEST_REGULARISATION_SPEED} rad/s (1 rpm is 0.105 rad/s)"
        ),
    );
    let speed = operation.rotation_speed_rpm;
    let slowest = regularisation * 30.0 / std::f64::consts::PI;
    report.require(
        bit.law == BitLaw::Constant || !speed.is_finite() || !slowest.is_finite() || speed.abs() >= slowest,
        "operation.rotation_speed_rpm",
        speed,
        format!(
            "must be at least {slowest:.3} rpm either way, bit.regularisation_speed: operation.torque_on_bit is that of a turning bit"
        ),
    );
}

fn check_cut(report: &mut Report, scenario: &Scenario) {
    let bit = &scenario.bit;
    if let Some(radius) = bit.bit_radius {
        report.number(
            radius,
            "bit.bit_radius",
            |radius| radius > 0.0 && radius <= LARGEST_BIT_RADIUS,
            format!("must be greater than 0 and at most {LARGEST_BIT_RADIUS} m (6 1/8 in is 0.0778 m)"),
        );
    }
    for (path, value, range, unit) in [
        ("bit.specific_energy", bit.specific_energy, SPECIFIC_ENERGIES, " Pa"),
        ("bit.inclination", bit.inclination, INCLINATIONS, ""),
        ("bit.contact_stress", bit.contact_stress, CONTACT_STRESSES, " Pa"),
        ("bit.wear_length", bit.wear_length, WEAR_LENGTHS, " m"),
        ("bit.friction_geometry", bit.friction_geometry, FRICTION_GEOMETRIES, ""),
    ] {
        let (least, most) = range.clone().into_inner();
        report.number(
            value,
            path,
            |value| range.contains(&value),
            format!("must be {least:?} to {most:?}{unit}"),
        );
    }
    report.require(
        BLADES.contains(&bit.blades),
        "bit.blades",
        bit.blades,
        format!("must be {} to {}", BLADES.start(), BLADES.end()),
    );
    if bit.law != BitLaw::Regenerative {
        return;
    }
    let torque = scenario.operation.torque_on_bit;
    report.number(
        torque,
        "operation.torque_on_bit",
        |torque| torque == 0.0,
        "follows from operation.weight_on_bit with the law regenerative: give 0",
    );
    report.require(
        bit.aggressiveness.is_none(),
        "bit.aggressiveness",
        "a number",
        "torque on bit follows from the cut with the law regenerative: leave it out",
    );
    let weight = -scenario.operation.weight_on_bit;
    let carried = bit.carried_weight(scenario.bit_radius());
    report.number(
        scenario.operation.weight_on_bit,
        "operation.weight_on_bit",
        |_| weight > carried || !carried.is_finite(),
        format!("the bit does not drill: its wear flats carry {carried:.0} N, bit_radius x wear_length x contact_stress; press it with more"),
    );
}

fn check_top_drive(report: &mut Report, drive: &TopDrive, operation: &Operation) {
    report.number(
        drive.gain,
        "top_drive.gain",
        |gain| gain > 0.0 && gain <= LARGEST_GAIN,
        format!("must be greater than 0 and at most {LARGEST_GAIN}"),
    );
    if let Some(frequency) = drive.frequency_hz {
        report.number(
            frequency,
            "top_drive.frequency_hz",
            |frequency| frequency > 0.0 && frequency <= HIGHEST_TUNING,
            format!("must be greater than 0 and at most {HIGHEST_TUNING} Hz"),
        );
    }
    report.number(
        drive.inertia,
        "top_drive.inertia",
        |inertia| (0.0..=LARGEST_INERTIA).contains(&inertia),
        format!("must be 0 to {LARGEST_INERTIA} kg m2"),
    );
    report.number(
        drive.inertia_compensation,
        "top_drive.inertia_compensation",
        |part| (0.0..=1.0).contains(&part),
        "must be 0 to 1",
    );
    report.number(
        drive.factor,
        "top_drive.factor",
        |factor| (0.0..=LARGEST_FACTOR).contains(&factor),
        format!("must be 0 to {LARGEST_FACTOR}"),
    );
    let (shortest, longest) = TIME_CONSTANTS.into_inner();
    report.number(
        drive.time_constant,
        "top_drive.time_constant",
        |time| TIME_CONSTANTS.contains(&time),
        format!("must be {shortest} to {longest} s"),
    );
    if drive.kind == TopDriveKind::ImposedSpeed {
        return;
    }
    report.require(
        operation.top != TopCondition::Continues,
        "top_drive.kind",
        "a drive",
        "there is no drive at a top that continues: operation.top must be `clamped` or `pinned`",
    );
    report.warn(
        drive.kind == TopDriveKind::SpeedControl
            && drive.tuning == Tuning::Soft
            && (1.0 - drive.inertia_compensation) * drive.inertia == 0.0,
        "top_drive.inertia_compensation",
        "without inertia the soft tuning has no integral part: a lasting change of torque changes the speed of the string for good",
    );
}

fn check_excitation(report: &mut Report, path: &str, force: &ExcitingForce, scenario: &Scenario) {
    check_amplitude(report, path, force);
    check_frequency(report, path, force, &scenario.operation);
    let highest = match (force.band_to_hz, force.frequency_hz, force.per_revolution) {
        (Some(to), ..) => to,
        (_, Some(frequency), _) => frequency,
        (_, _, Some(cycles)) => cycles * scenario.operation.rotation_speed_rpm.abs() / 60.0,
        _ => 0.0,
    };
    report.warn(
        highest > 0.5 * scenario.recording.rate_hz,
        path,
        "is faster than half of recording.rate_hz: spectra show its response at a lower frequency",
    );
}

fn check_amplitude(report: &mut Report, path: &str, force: &ExcitingForce) {
    let is_torsional = force.direction == ExcitationDirection::Torsional;
    let (own, other, unit, most) = if is_torsional {
        (("torque", force.torque), ("force", force.force), "N m", LARGEST_TORQUE)
    } else {
        (("force", force.force), ("torque", force.torque), "N", LARGEST_FORCE)
    };
    match own.1 {
        Some(amplitude) => report.number(
            amplitude,
            format!("{path}.{}", own.0),
            |amplitude| (0.0..=most).contains(&amplitude),
            format!("must be 0 to {most:e} {unit}"),
        ),
        None => report.require(false, path, "no amplitude", format!("give {} in {unit}", own.0)),
    }
    if let Some(amplitude) = other.1 {
        let message = format!("does not belong to this direction: give {}", own.0);
        report.require(false, format!("{path}.{}", other.0), amplitude, message);
    }
}

fn check_frequency(report: &mut Report, path: &str, force: &ExcitingForce, operation: &Operation) {
    const EITHER: &str = "give either frequency_hz or per_revolution";
    let is_band = force.band_to_hz.is_some();
    match (force.frequency_hz, force.per_revolution) {
        (Some(_), Some(cycles)) => {
            report.require(false, format!("{path}.per_revolution"), cycles, format!("{EITHER}, not both"));
        }
        (None, None) => report.require(false, path, "no frequency", EITHER),
        (Some(frequency), None) => report.number(
            frequency,
            format!("{path}.frequency_hz"),
            |frequency| (frequency > 0.0 || is_band && frequency == 0.0) && frequency <= HIGHEST_FREQUENCY,
            format!("must be greater than 0 and at most {HIGHEST_FREQUENCY} Hz"),
        ),
        (None, Some(cycles)) => {
            let field = format!("{path}.per_revolution");
            report.number(
                cycles,
                &field,
                |cycles| cycles > 0.0 && cycles <= MOST_CYCLES,
                format!("must be greater than 0 and at most {MOST_CYCLES}"),
            );
            report.require(
                operation.rotation_speed_rpm != 0.0,
                &field,
                cycles,
                "the string does not turn: give frequency_hz",
            );
        }
    }
    let Some(to) = force.band_to_hz else { return };
    let field = format!("{path}.band_to_hz");
    let from = force.frequency_hz.unwrap_or(f64::NAN);
    report.number(
        to,
        &field,
        |to| (from.is_nan() || to > from) && to <= HIGHEST_FREQUENCY,
        format!("must be greater than frequency_hz and at most {HIGHEST_FREQUENCY} Hz"),
    );
    report.require(
        force.per_revolution.is_none() && force.direction != ExcitationDirection::LateralRotating,
        field,
        to,
        "belongs to frequency_hz, and to a force that does not turn",
    );
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::Scenario;
    use serde_json::{Value, json};

    use super::*;
    use crate::validation::report::testing::{problem, problems, warnings};

    fn with(path: &'static str, value: Value) -> impl Fn(&mut Scenario) {
        move |scenario| *scenario = scenario.with(path, value.clone()).unwrap()
    }

    fn shaken(change: Value) -> impl Fn(&mut Scenario) {
        let mut force =
            json!({ "above_bit": 10.0, "direction": "axial", "force": 1e4, "frequency_hz": 18.0 });
        let Value::Object(fields) = change else { panic!("fields of a force, not {change}") };
        force.as_object_mut().unwrap().extend(fields);
        with("excitation", json!([force]))
    }

    #[test]
    fn laws_drives_and_forces_within_their_ranges_are_valid() {
        assert_eq!(warnings(with("bit", json!({ "law": "velocity_weakening" }))), []);
        assert_eq!(warnings(with("top_drive", json!({ "kind": "speed_control", "tuning": "soft" }))), []);
        assert_eq!(warnings(shaken(json!({}))), []);
        assert_eq!(warnings(shaken(json!({ "frequency_hz": 0.0, "band_to_hz": 30.0 }))), []);
        let turning = json!({ "direction": "lateral_rotating", "frequency_hz": null, "per_revolution": 3.0 });
        assert_eq!(warnings(shaken(turning)), []);
        assert_eq!(warnings(shaken(json!({ "direction": "torsional", "force": null, "torque": 500.0 }))), []);
    }

    #[test]
    fn numbers_out_of_range_name_their_field() {
        for (path, value) in [
            ("bit.static_ratio", 0.9),
            ("bit.weakening_speed", 0.0),
            ("bit.regularisation_speed", 11.0),
            ("top_drive.gain", 0.0),
            ("top_drive.frequency_hz", 11.0),
            ("top_drive.inertia", -1.0),
            ("top_drive.inertia_compensation", 1.1),
            ("top_drive.factor", -0.1),
            ("top_drive.time_constant", 0.0),
        ] {
            problem(path, with(path, json!(value)));
        }
        for (field, value) in
            [("frequency_hz", 0.0), ("force", -1.0), ("band_to_hz", 18.0), ("above_bit", 201.0)]
        {
            problem(&format!("excitation[0].{field}"), shaken(json!({ field: value })));
        }
    }

    #[test]
    fn fields_that_exclude_each_other_are_refused() {
        let slow = |scenario: &mut Scenario| {
            with("bit.law", json!("velocity_weakening"))(scenario);
            scenario.operation.rotation_speed_rpm = 0.5;
        };
        problem("operation.rotation_speed_rpm", slow);
        let aggressive = |torque: f64| {
            move |scenario: &mut Scenario| {
                (scenario.bit.aggressiveness, scenario.operation.torque_on_bit) = (Some(0.8), torque);
            }
        };
        problem("operation.torque_on_bit", aggressive(-4000.0));
        assert_eq!(warnings(aggressive(0.0)), []);
        problem("bit.aggressiveness", |scenario| {
            aggressive(0.0)(scenario);
            scenario.bit.aggressiveness = Some(-0.1);
        });
        let open = |scenario: &mut Scenario| {
            with("top_drive.kind", json!("speed_control"))(scenario);
            scenario.operation.top = TopCondition::Continues;
        };
        problem("top_drive.kind", open);
        let judged = |scenario: &mut Scenario| {
            with("top_drive.kind", json!("z_torque"))(scenario);
            scenario.recording.stability = true;
        };
        problem("recording.stability", judged);
        problem("excitation[0].above_bit", shaken(json!({ "measured_depth": 10.0 })));
        problem("excitation[0]", shaken(json!({ "above_bit": null })));
        problem("excitation[0].per_revolution", shaken(json!({ "per_revolution": 3.0 })));
        problem("excitation[0].torque", shaken(json!({ "torque": 3.0 })));
        problem("excitation[0]", shaken(json!({ "force": null })));
        problem(
            "excitation[0].band_to_hz",
            shaken(json!({ "direction": "lateral_rotating", "band_to_hz": 20.0 })),
        );
        let many =
            vec![json!({ "above_bit": 0.0, "direction": "axial", "force": 1.0, "frequency_hz": 1.0 }); 65];
        assert_eq!(problems(with("excitation", json!(many)))[0].path, "excitation");
    }

    #[test]
    fn a_regenerative_bit_has_windows_and_no_run() {
        let regenerative = |change: Value| {
            let mut bit = json!({ "law": "regenerative", "wear_length": 1e-3 });
            bit.as_object_mut().unwrap().extend(change.as_object().unwrap().clone());
            let operation =
                json!({ "rotation_speed_rpm": 120.0, "weight_on_bit": -1e5, "torque_on_bit": 0.0 });
            let scenario = drillsweep_scenario::preset("paper-200m").unwrap();
            scenario.with("bit", bit).unwrap().with("operation", operation).unwrap()
        };
        let paths = |problems: drillsweep_scenario::Problems| {
            problems.0.iter().map(|problem| problem.path.clone()).collect::<Vec<_>>()
        };
        let scenario = regenerative(json!({}));
        assert_eq!(crate::validation::validate_stability_map(&scenario), Ok(vec![]));
        let problems = crate::validation::validate(&scenario).unwrap_err();
        assert!(problems.to_string().contains("stability maps only"), "{problems}");
        assert_eq!(paths(problems), ["bit.law"]);
        for (change, path) in [
            (json!({ "bit_radius": 0.0 }), "bit.bit_radius"),
            (json!({ "specific_energy": 1e4 }), "bit.specific_energy"),
            (json!({ "inclination": 0.0 }), "bit.inclination"),
            (json!({ "contact_stress": -1.0 }), "bit.contact_stress"),
            (json!({ "friction_geometry": 11.0 }), "bit.friction_geometry"),
            (json!({ "blades": 0 }), "bit.blades"),
            (json!({ "aggressiveness": 0.8 }), "bit.aggressiveness"),
            // 0.1 m x 20 mm x 60 MPa are 120 kN or more.
            (json!({ "wear_length": 0.02 }), "operation.weight_on_bit"),
        ] {
            let found = crate::validation::validate_stability_map(&regenerative(change)).unwrap_err();
            assert_eq!(paths(found), [path]);
        }
        let mut scenario = scenario;
        scenario.operation.torque_on_bit = -1e3;
        let found = crate::validation::validate_stability_map(&scenario).unwrap_err();
        assert_eq!(paths(found), ["operation.torque_on_bit"]);
    }

    #[test]
    fn forces_without_effect_and_drives_without_integral_are_warned_of() {
        let path = |warnings: Vec<drillsweep_scenario::Warning>| {
            assert_eq!(warnings.len(), 1, "{warnings:?}");
            warnings[0].path.clone()
        };
        let drive = json!({ "kind": "speed_control", "tuning": "soft", "inertia_compensation": 1.0 });
        assert_eq!(path(warnings(with("top_drive", drive))), "top_drive.inertia_compensation");
        assert_eq!(path(warnings(shaken(json!({ "above_bit": 200.0 })))), "excitation[0].above_bit");
        let coarse = |scenario: &mut Scenario| {
            shaken(json!({ "frequency_hz": 60.0 }))(scenario);
            scenario.recording.rate_hz = 100.0;
        };
        assert_eq!(path(warnings(coarse)), "excitation[0]");
    }
}
