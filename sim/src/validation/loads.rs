//! Rules of mud, operation, contact and damping.

use std::ops::RangeInclusive;

use drillsweep_scenario::{
    ContactLaw, Hydraulics, Mud, Operation, Scenario, StartFriction, TopCondition, WallLaw,
};

use super::report::Report;
use crate::force::effect::active_effects;
use crate::force::mud::SURFACE_CASES;

/// Densities of muds \[kg/m3\] from oil to the heaviest weighted ones, 21.7 lb/gal.
const USUAL_MUD_DENSITIES: RangeInclusive<f64> = 800.0..=2600.0;

/// Density of the heaviest mud \[kg/m3\]: heavier liquids are molten metals and mercury.
const HEAVIEST_MUD: f64 = 10_000.0;

/// Flow rates \[m3/s\] up to that of three large pumps, 1900 gal/min.
const USUAL_FLOW_RATES: RangeInclusive<f64> = 0.0..=0.12;

/// Yield stresses \[Pa\] up to those of gels, 200 lbf/100 ft2.
const USUAL_YIELD_STRESSES: RangeInclusive<f64> = 0.0..=100.0;

/// Pressures \[Pa\] up to above the ratings of pumps and blowout preventers, 15,000 psi.
const USUAL_PRESSURES: RangeInclusive<f64> = 0.0..=1.1e8;

/// Largest number of nozzles of a bit; the largest hole openers have some 20.
const MOST_NOZZLES: usize = 24;

/// Largest diameter of a nozzle \[m\]: an open bore.
const LARGEST_NOZZLE: f64 = 0.1;

/// Largest flow area of a bit \[m2\], 155 in2.
const LARGEST_FLOW_AREA: f64 = 0.1;

/// Discharge coefficients from a sharp-edged orifice to the pressure recovery of modern bits.
const DISCHARGE_COEFFICIENTS: RangeInclusive<f64> = 0.5..=1.2;

/// Longest surface lines \[m\] as an equivalent pipe; the narrowest equipment is some 800 m of 3.826 in.
const LONGEST_SURFACE_LINES: f64 = 10_000.0;

/// Widest surface lines \[m\].
const WIDEST_SURFACE_LINES: f64 = 0.5;

/// Usual speeds of rotation from above \[rpm\], either way; top drives reach 200 to 300.
const USUAL_ROTATION: RangeInclusive<f64> = -400.0..=400.0;

/// Largest speed of rotation \[rpm\]: with it the surface of a pipe of 0.2 m moves at 100 m/s.
const FASTEST_ROTATION: f64 = 10_000.0;

/// Largest axial speed of a string \[m/s\]; trips take 0.5 to 2.
const FASTEST_TRIP: f64 = 10.0;

/// Longest pipe above a string \[m\]; the longest wells have 15 km.
const LONGEST_STRING_ABOVE: f64 = 2e4;

/// Axial forces at a bit \[N\], either way: the largest bits carry some 500 kN.
const USUAL_WEIGHT_ON_BIT: RangeInclusive<f64> = -6e5..=6e5;

/// Largest force \[N\]: ten times the hook load of the largest rigs.
const LARGEST_FORCE: f64 = 1e8;

/// Torques \[N m\], either way, up to those of the largest top drives.
const USUAL_TORQUES: RangeInclusive<f64> = -1e5..=1e5;

/// Friction coefficients up to that of dry steel on dry rock.
const USUAL_FRICTION: RangeInclusive<f64> = 0.0..=1.0;

/// Largest friction coefficient: rubber on dry rock has 1 to 4.
const LARGEST_FRICTION: f64 = 10.0;

pub(super) fn check(report: &mut Report, scenario: &Scenario) {
    if let Some(mud) = &scenario.mud {
        check_mud(report, mud);
    }
    check_hydraulics(report, scenario);
    check_operation(report, &scenario.operation);
    report.warn(
        scenario.operation.top == TopCondition::Continues
            && scenario.operation.length_above.is_none()
            && scenario.statics.friction == StartFriction::BreakAway,
        "statics.friction",
        "without `operation.length_above` no drive returns the top to its speed: friction that falls from `break_away` to that of sliding leaves \
         the string turning faster; start from `sliding`",
    );
    let speed = scenario.operation.axial_speed;
    if speed.is_finite() && speed != 0.0 {
        report.require(
            !active_effects(scenario).transient,
            "operation.axial_speed",
            speed,
            "acts on the equilibrium alone, not on a run in time: with it `effects.transient` must be `off`",
        );
        report.require(
            !scenario.recording.stability,
            "operation.axial_speed",
            speed,
            "acts on the equilibrium alone: with it `recording.stability` must be false",
        );
    }
    check_contact(report, &scenario.contact);
    report.not_negative(scenario.damping.mass_proportional, "damping.mass_proportional");
    report.not_negative(scenario.damping.stiffness_proportional, "damping.stiffness_proportional");
}

fn check_mud(report: &mut Report, mud: &Mud) {
    report.positive(mud.density, "mud.density");
    report.number(
        mud.density,
        "mud.density",
        |density| density <= HEAVIEST_MUD,
        format!("must be at most {HEAVIEST_MUD} kg/m3 (10 lb/gal is 1198 kg/m3)"),
    );
    report.usual(mud.density, "mud.density", &USUAL_MUD_DENSITIES, "kg/m3");
    report.number(
        mud.flow_rate,
        "mud.flow_rate",
        |rate| (0.0..=1.0).contains(&rate),
        "must be 0 to 1 m3/s (10 l/s is 0.01 m3/s)",
    );
    report.usual(mud.flow_rate, "mud.flow_rate", &USUAL_FLOW_RATES, "m3/s");
    report.not_negative(mud.yield_stress, "mud.yield_stress");
    report.usual(mud.yield_stress, "mud.yield_stress", &USUAL_YIELD_STRESSES, "Pa");
    report.positive(mud.consistency, "mud.consistency");
    report.number(
        mud.flow_index,
        "mud.flow_index",
        |index| index > 0.0 && index <= 2.0,
        "must be greater than 0 and at most 2 (1 is a Bingham fluid, less is shear-thinning)",
    );
    report.not_negative(mud.bit_pressure_drop, "mud.bit_pressure_drop");
    report.usual(mud.bit_pressure_drop, "mud.bit_pressure_drop", &USUAL_PRESSURES, "Pa");
    report.not_negative(mud.back_pressure, "mud.back_pressure");
    report.usual(mud.back_pressure, "mud.back_pressure", &USUAL_PRESSURES, "Pa");
}

fn check_hydraulics(report: &mut Report, scenario: &Scenario) {
    let hydraulics = &scenario.hydraulics;
    let nozzles = &hydraulics.nozzles;
    report.require(
        nozzles.len() <= MOST_NOZZLES,
        "hydraulics.nozzles",
        format!("{} nozzles", nozzles.len()),
        format!("must be at most {MOST_NOZZLES} nozzles"),
    );
    for (i, &diameter) in nozzles.iter().enumerate().take(MOST_NOZZLES) {
        report.number(
            diameter,
            format!("hydraulics.nozzles[{i}]"),
            |diameter| diameter > 0.0 && diameter <= LARGEST_NOZZLE,
            format!("must be greater than 0 and at most {LARGEST_NOZZLE} m (16/32 in is 0.0127 m)"),
        );
    }
    if let Some(area) = hydraulics.nozzle_area {
        report.number(
            area,
            "hydraulics.nozzle_area",
            |area| area > 0.0 && area <= LARGEST_FLOW_AREA,
            format!("must be greater than 0 and at most {LARGEST_FLOW_AREA} m2 (1 in2 is 6.4516e-4 m2)"),
        );
        report.require(
            nozzles.is_empty(),
            "hydraulics.nozzle_area",
            area,
            "takes the place of hydraulics.nozzles: give one of them",
        );
    }
    let drop = scenario.mud.map_or(0.0, |mud| mud.bit_pressure_drop);
    report.require(
        hydraulics.flow_area().is_none() || drop == 0.0,
        "mud.bit_pressure_drop",
        drop,
        "is the loss of the bit, which nozzles give: leave it out, and give the loss of tools as hydraulics.tool_pressure_drop",
    );
    report.number(
        hydraulics.discharge_coefficient,
        "hydraulics.discharge_coefficient",
        |coefficient| DISCHARGE_COEFFICIENTS.contains(&coefficient),
        "must be 0.5 to 1.2 (0.95 in API RP 13D)",
    );
    report.not_negative(hydraulics.tool_pressure_drop, "hydraulics.tool_pressure_drop");
    let tools = hydraulics.tool_pressure_drop;
    report.usual(tools, "hydraulics.tool_pressure_drop", &USUAL_PRESSURES, "Pa");
    check_surface_lines(report, hydraulics);
}

fn check_surface_lines(report: &mut Report, hydraulics: &Hydraulics) {
    let length = hydraulics.surface_length;
    if let Some(case) = hydraulics.surface_case {
        report.require(
            (1..=SURFACE_CASES).contains(&case),
            "hydraulics.surface_case",
            case,
            format!("must be 1 to {SURFACE_CASES}, a case of surface equipment of API RP 13D"),
        );
        report.number(
            length,
            "hydraulics.surface_length",
            |length| length == 0.0,
            "takes the place of hydraulics.surface_case: give one of them",
        );
    }
    report.number(
        length,
        "hydraulics.surface_length",
        |length| (0.0..=LONGEST_SURFACE_LINES).contains(&length),
        format!("must be 0 to {LONGEST_SURFACE_LINES} m"),
    );
    report.number(
        hydraulics.surface_diameter,
        "hydraulics.surface_diameter",
        |diameter| diameter > 0.0 && diameter <= WIDEST_SURFACE_LINES,
        format!("must be greater than 0 and at most {WIDEST_SURFACE_LINES} m (4 in is 0.1016 m)"),
    );
}

fn check_operation(report: &mut Report, operation: &Operation) {
    let weight = operation.weight_on_bit;
    report.number(
        weight,
        "operation.weight_on_bit",
        |weight| weight.abs() <= LARGEST_FORCE,
        format!("must be at most {LARGEST_FORCE:e} N either way (10,000 lbf are 44.5 kN)"),
    );
    report.usual(weight, "operation.weight_on_bit", &USUAL_WEIGHT_ON_BIT, "N either way");
    report.warn(
        weight > 0.0,
        "operation.weight_on_bit",
        format!(
            "the bit is pulled with {weight} N (overpull): if it is to be pressed on, compression is negative, {}",
            -weight
        ),
    );
    let (torque, speed) = (operation.torque_on_bit, operation.rotation_speed_rpm);
    report.number(
        torque,
        "operation.torque_on_bit",
        |torque| !speed.is_finite() || torque * speed <= 0.0,
        format!(
            "torque_on_bit is the torque of the rock on the bit: it opposes the rotation of {speed} rpm; {} rather \
             than {torque}?",
            -torque
        ),
    );
    report.usual(torque, "operation.torque_on_bit", &USUAL_TORQUES, "N m either way");
    report.number(
        speed,
        "operation.rotation_speed_rpm",
        |speed| speed.abs() <= FASTEST_ROTATION,
        format!("must be at most {FASTEST_ROTATION} rpm either way"),
    );
    report.usual(speed, "operation.rotation_speed_rpm", &USUAL_ROTATION, "rpm either way");
    report.number(
        operation.axial_speed,
        "operation.axial_speed",
        |speed| speed.abs() <= FASTEST_TRIP,
        format!("must be at most {FASTEST_TRIP} m/s either way"),
    );
    if let Some(length) = operation.length_above {
        report.number(
            length,
            "operation.length_above",
            |length| length > 0.0 && length <= LONGEST_STRING_ABOVE,
            format!("must be above 0 and at most {LONGEST_STRING_ABOVE} m"),
        );
        report.require(
            operation.top == TopCondition::Continues,
            "operation.length_above",
            length,
            "there is pipe above the string only if `operation.top` is `continues`",
        );
    }
}

fn check_contact(report: &mut Report, contact: &ContactLaw) {
    report.positive(contact.stiffness, "contact.stiffness");
    report.not_negative(contact.damping, "contact.damping");
    if let Some(stiffness) = contact.stiffness_per_length
        && belongs(report, contact, "stiffness", stiffness)
    {
        let message = "must be greater than 0 N/m2, of a metre of string";
        report.number(stiffness, "contact.stiffness_per_length", |stiffness| stiffness > 0.0, message);
    }
    if let Some(damping) = contact.damping_per_length
        && belongs(report, contact, "damping", damping)
    {
        let message = "must be 0 N s/m2 or greater, of a metre of string";
        report.number(damping, "contact.damping_per_length", |damping| damping >= 0.0, message);
    }
    report.positive(contact.stiffness_sharpness, "contact.stiffness_sharpness");
    report.positive(contact.damping_sharpness, "contact.damping_sharpness");
    static_friction(report, contact.static_friction, "contact.static_friction");
    dynamic_friction(report, contact.dynamic_friction, contact.static_friction, "contact.dynamic_friction");
    report.positive(contact.friction_reference_speed, "contact.friction_reference_speed");
}

/// A static friction coefficient.
pub(super) fn static_friction(report: &mut Report, friction: f64, path: &str) {
    report.not_negative(friction, path);
    report.number(
        friction,
        path,
        |friction| friction <= LARGEST_FRICTION,
        format!("must be at most {LARGEST_FRICTION} (30 % is 0.3)"),
    );
    report.usual(friction, path, &USUAL_FRICTION, "");
}

/// A dynamic friction coefficient next to the static one of the same place.
pub(super) fn dynamic_friction(report: &mut Report, friction: f64, largest: f64, path: &str) {
    report.not_negative(friction, path);
    if largest.is_finite() && largest >= 0.0 {
        report.number(
            friction,
            path,
            |friction| friction <= largest,
            format!(
                "must be at most static_friction, {largest}: xi = sqrt(1 - mu_d / mu_s) has no value beyond"
            ),
        );
    }
}

/// True if the value of a length belongs to the law; reports a value that the law does not use.
fn belongs(report: &mut Report, contact: &ContactLaw, field: &str, value: f64) -> bool {
    let belongs = contact.law == WallLaw::PerLength;
    report.require(
        belongs || !value.is_finite(),
        format!("contact.{field}_per_length"),
        value,
        format!("belongs to contact.law = \"per_length\"; with \"per_node\" every node has contact.{field}"),
    );
    belongs
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Hydraulics, Mud, Scenario, WallLaw};

    use super::super::report::testing::{problem, warnings};

    fn mud_problem(field: &str, change: impl Fn(&mut Mud)) -> String {
        problem(&format!("mud.{field}"), |s| change(s.mud.as_mut().unwrap())).message
    }

    #[test]
    fn mud_has_a_density() {
        for density in [0.0, -1200.0] {
            mud_problem("density", |mud| mud.density = density);
        }
    }

    #[test]
    fn flow_goes_down_the_pipe_at_a_possible_rate() {
        for rate in [-0.01, 10.0] {
            assert!(mud_problem("flow_rate", |mud| mud.flow_rate = rate).contains("l/s"));
        }
        assert_eq!(warnings(|s| s.mud.as_mut().unwrap().flow_rate = 0.0), []);
    }

    #[test]
    fn rheology_is_physical() {
        mud_problem("yield_stress", |mud| mud.yield_stress = -0.1);
        for consistency in [0.0, -0.07] {
            mud_problem("consistency", |mud| mud.consistency = consistency);
        }
        for index in [0.0, -0.5, 2.5] {
            mud_problem("flow_index", |mud| mud.flow_index = index);
        }
        let newtonian = |mud: &mut Mud| (mud.yield_stress, mud.flow_index) = (0.0, 1.0);
        assert_eq!(warnings(|s| newtonian(s.mud.as_mut().unwrap())), []);
    }

    #[test]
    fn pressures_are_not_negative() {
        mud_problem("bit_pressure_drop", |mud| mud.bit_pressure_drop = -1.0);
        mud_problem("back_pressure", |mud| mud.back_pressure = -1.0);
    }

    #[test]
    fn nozzles_and_surface_lines_are_possible_and_given_once() {
        let of = |path: &str, change: fn(&mut Hydraulics)| {
            problem(&format!("hydraulics.{path}"), |s| change(&mut s.hydraulics)).message
        };
        assert!(of("nozzles[1]", |h| h.nozzles = vec![0.01, 12.0]).contains("16/32 in"));
        assert!(of("nozzles", |h| h.nozzles = vec![0.01; 25]).contains("at most 24"));
        of("nozzle_area", |h| h.nozzle_area = Some(0.0));
        of("nozzle_area", |h| (h.nozzles, h.nozzle_area) = (vec![0.01], Some(3e-4)));
        of("discharge_coefficient", |h| h.discharge_coefficient = 0.0);
        of("tool_pressure_drop", |h| h.tool_pressure_drop = -1.0);
        for case in [0, 5] {
            let found = problem("hydraulics.surface_case", |s| s.hydraulics.surface_case = Some(case));
            assert!(found.message.contains("1 to 4"), "{found}");
        }
        of("surface_length", |h| h.surface_length = -1.0);
        of("surface_length", |h| (h.surface_case, h.surface_length) = (Some(4), 100.0));
        of("surface_diameter", |h| h.surface_diameter = 4.0);
        let found = problem("mud.bit_pressure_drop", |s| {
            s.hydraulics.nozzles = vec![0.01; 3];
            s.mud.as_mut().unwrap().bit_pressure_drop = 1e6;
        });
        assert!(found.message.contains("tool_pressure_drop"), "{found}");
        let whole = |h: &mut Hydraulics| {
            (h.nozzles, h.surface_case, h.tool_pressure_drop) = (vec![0.0127; 6], Some(1), 2e6);
        };
        assert_eq!(warnings(|s| whole(&mut s.hydraulics)), []);
    }

    #[test]
    fn a_pulled_bit_is_warned_of_as_a_sign_may_be_lost() {
        let found = warnings(|s| s.operation.weight_on_bit = 1e5);
        assert_eq!((found.len(), found[0].path.as_str()), (1, "operation.weight_on_bit"));
        assert!(found[0].message.ends_with("compression is negative, -100000"), "{found:?}");
        assert_eq!(warnings(|s| s.operation.weight_on_bit = 0.0), []);
    }

    #[test]
    fn torque_on_bit_opposes_the_rotation() {
        let found = problem("operation.torque_on_bit", |s| s.operation.torque_on_bit = 5000.0);
        assert!(found.message.contains("-5000 rather than 5000?"), "{found}");
        problem("operation.torque_on_bit", |s| s.operation.rotation_speed_rpm = -120.0);
        let backwards = |s: &mut drillsweep_scenario::Scenario| {
            (s.operation.rotation_speed_rpm, s.operation.torque_on_bit) = (-120.0, 5000.0);
        };
        assert_eq!(warnings(backwards), []);
        assert_eq!(warnings(|s| s.operation.rotation_speed_rpm = 0.0), []);
    }

    #[test]
    fn pipe_above_the_string_belongs_to_a_top_that_continues() {
        let continues = |s: &mut drillsweep_scenario::Scenario| {
            s.operation.top = drillsweep_scenario::TopCondition::Continues;
            s.statics.friction = drillsweep_scenario::StartFriction::Sliding;
        };
        assert_eq!(warnings(continues), []);
        let found = problem("operation.length_above", |s| s.operation.length_above = Some(500.0));
        assert!(found.message.contains("`continues`"), "{found}");
        for length in [0.0, -1.0, 3e4, f64::NAN] {
            problem("operation.length_above", |s| {
                continues(s);
                s.operation.length_above = Some(length);
            });
        }
        let doubted = |length| {
            warnings(|s| {
                (s.operation.top, s.operation.length_above) =
                    (drillsweep_scenario::TopCondition::Continues, length);
            })
        };
        assert_eq!(doubted(None)[0].path, "statics.friction");
        assert_eq!(doubted(Some(3000.0)), []);
    }

    #[test]
    fn contact_constants_are_physical() {
        problem("contact.stiffness", |s| s.contact.stiffness = 0.0);
        problem("contact.damping", |s| s.contact.damping = -1.0);
        problem("contact.stiffness_sharpness", |s| s.contact.stiffness_sharpness = 0.0);
        problem("contact.damping_sharpness", |s| s.contact.damping_sharpness = 0.0);
        problem("contact.friction_reference_speed", |s| s.contact.friction_reference_speed = 0.0);
        problem("contact.static_friction", |s| s.contact.static_friction = -0.3);
        problem("contact.dynamic_friction", |s| s.contact.dynamic_friction = -0.2);
    }

    #[test]
    fn stiffness_and_damping_of_a_length_belong_to_the_law_per_length() {
        let set = |s: &mut Scenario, stiffness, damping| {
            (s.contact.stiffness_per_length, s.contact.damping_per_length) = (stiffness, damping);
        };
        let by_length = |s: &mut Scenario| s.contact.law = WallLaw::PerLength;
        assert_eq!(warnings(by_length), []);
        for bad in [0.0, -2e7] {
            let found = problem("contact.stiffness_per_length", |s| {
                by_length(s);
                set(s, Some(bad), Some(0.0));
            });
            assert!(found.message.contains("N/m2"), "{found}");
        }
        let found = problem("contact.damping_per_length", |s| {
            by_length(s);
            set(s, None, Some(-2e4));
        });
        assert!(found.message.contains("N s/m2"), "{found}");
        let found = problem("contact.stiffness_per_length", |s| set(s, Some(2e7), None));
        assert!(found.message.contains("per_node") && found.message.contains("contact.stiffness"), "{found}");
        problem("contact.damping_per_length", |s| set(s, None, Some(2e4)));
    }

    #[test]
    fn dynamic_friction_is_at_most_static_friction() {
        let found = problem("contact.dynamic_friction", |s| s.contact.dynamic_friction = 0.31);
        assert!(found.message.contains("0.3"), "{found}");
        assert_eq!(warnings(|s| s.contact.dynamic_friction = 0.3), []);
        let frictionless = |s: &mut drillsweep_scenario::Scenario| {
            (s.contact.static_friction, s.contact.dynamic_friction) = (0.0, 0.0);
        };
        assert_eq!(warnings(frictionless), []);
    }

    #[test]
    fn damping_takes_energy_out() {
        problem("damping.mass_proportional", |s| s.damping.mass_proportional = -0.03);
        problem("damping.stiffness_proportional", |s| s.damping.stiffness_proportional = -1e-6);
    }

    #[test]
    fn units_that_look_wrong_earn_a_warning() {
        let doubted = |path: &str, change: &dyn Fn(&mut Scenario)| {
            let found = warnings(change);
            assert_eq!((found.len(), found[0].path.as_str()), (1, path), "{found:?}");
            assert!(found[0].message.contains("usual range"), "{found:?}");
        };
        let mud = |change: fn(&mut Mud)| move |s: &mut Scenario| change(s.mud.as_mut().unwrap());
        doubted("mud.density", &mud(|mud| mud.density = 1.2));
        doubted("mud.density", &mud(|mud| mud.density = 2601.0));
        doubted("mud.flow_rate", &mud(|mud| mud.flow_rate = 0.6));
        doubted("mud.yield_stress", &mud(|mud| mud.yield_stress = 290.0));
        doubted("mud.bit_pressure_drop", &mud(|mud| mud.bit_pressure_drop = 3e9));
        doubted("mud.back_pressure", &mud(|mud| mud.back_pressure = 1e9));
        doubted("operation.rotation_speed_rpm", &|s| s.operation.rotation_speed_rpm = 720.0);
        doubted("operation.weight_on_bit", &|s| s.operation.weight_on_bit = -1e6);
        doubted("operation.torque_on_bit", &|s| s.operation.torque_on_bit = -1e6);
        doubted("contact.static_friction", &|s| s.contact.static_friction = 3.0);
        assert_eq!(warnings(mud(|mud| (mud.density, mud.flow_rate) = (2600.0, 0.12))), []);
        assert_eq!(warnings(|s| s.operation.rotation_speed_rpm = 400.0), []);
        assert_eq!(warnings(|s| s.contact.static_friction = 1.0), []);
    }

    #[test]
    fn the_impossible_is_refused() {
        for density in [10_001.0, 1.8e9] {
            assert!(mud_problem("density", |mud| mud.density = density).contains("lb/gal"));
        }
        problem("contact.static_friction", |s| s.contact.static_friction = 30.0);
        problem("operation.rotation_speed_rpm", |s| s.operation.rotation_speed_rpm = 12_000.0);
        problem("operation.weight_on_bit", |s| s.operation.weight_on_bit = -1e9);
    }
}
