//! Kinds of quantities by the units in which they are kept, shown and read.

use serde::{Deserialize, Serialize};

/// System of units in which quantities are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum UnitSystem {
    /// SI, with prefixes.
    #[default]
    Si,
    /// Units of the oil field.
    Field,
}

/// A further unit of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Symbol, such as `mm`.
    pub symbol: &'static str,
    /// Size in the unit in which the quantity is kept: 0.0254 for an inch of a length in metres.
    pub size: f64,
}

impl Unit {
    /// A value in this unit.
    pub fn of(&self, value: f64) -> f64 {
        value / self.size
    }

    /// A value in this unit as a table has it: the number that was read in it, if it was one of up to fifteen digits; the quotient
    /// otherwise. Both are the value to the rounding of doubles.
    pub fn written(&self, value: f64) -> f64 {
        /// Most that a product deviates by from a number that was rounded once, in parts of it.
        const ROUNDING: f64 = 2.0 * f64::EPSILON;
        if self.size == 1.0 {
            return value;
        }
        let quotient = self.of(value);
        // The quotient is off by 1.5 units in the last place of a double at most, less than half of the fifteenth digit.
        let short = fifteen_digits(quotient);
        if (short * self.size - value).abs() <= ROUNDING * value.abs() { short } else { quotient }
    }

    /// Its symbol as texts have it, such as `N·s/m²`; empty of ratios.
    pub fn text(&self) -> String {
        match self.symbol {
            "1" => return String::new(),
            "deg" => return "°".to_owned(),
            _ => {}
        }
        let mut text = String::new();
        for sign in self.symbol.chars() {
            let is_raised = text.ends_with(|last: char| last.is_ascii_alphabetic());
            text.push(match sign {
                ' ' => '·',
                '2' if is_raised => '²',
                '3' if is_raised => '³',
                sign => sign,
            });
        }
        text
    }
}

/// The double nearest to the first fifteen digits of a number.
fn fifteen_digits(number: f64) -> f64 {
    /// Bounds of a number of fifteen digits.
    const DIGITS: std::ops::Range<f64> = 1e14..1e15;
    let magnitude = number.abs();
    if !magnitude.is_normal() {
        return number;
    }
    let mut power = 14 - magnitude.log10().floor() as i32;
    // Beyond, powers of ten are not exact.
    if power.abs() > 21 {
        return format!("{number:.14e}").parse().unwrap_or(number);
    }
    let scaled = |power: i32| {
        let scale = 10_f64.powi(power.abs());
        if power < 0 { magnitude / scale } else { magnitude * scale }
    };
    // The logarithm is rounded.
    match scaled(power) {
        below if below < DIGITS.start => power += 1,
        above if above >= DIGITS.end => power -= 1,
        _ => {}
    }
    let digits = scaled(power).round_ties_even();
    let scale = 10_f64.powi(power.abs());
    (if power < 0 { digits * scale } else { digits / scale }).copysign(number)
}

/// The units of one kind of quantity.
///
/// Two kinds may have one dimension: depths are read in metres and feet, diameters and displacements in millimetres and inches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// The dimension, in words.
    pub dimension: &'static str,
    /// The unit in which values are kept, and served: SI, unless the quantity's name says otherwise (`_rpm`, `_deg`). `1` for ratios.
    pub kept: &'static str,
    /// The unit in which pictures show it.
    pub shown: Unit,
    /// The unit in which the oil field reads it.
    pub field: Unit,
}

impl Units {
    /// The unit in which readers of a system read it.
    pub fn of(&self, system: UnitSystem) -> Unit {
        match system {
            UnitSystem::Si => self.shown,
            UnitSystem::Field => self.field,
        }
    }
}

/// International foot \[m\], exact.
const FOOT: f64 = 0.3048;
/// Inch \[m\], exact.
const INCH: f64 = 0.0254;
/// US gallon \[m3\], 231 cubic inches, exact.
const GALLON: f64 = 0.003_785_411_784;
/// Avoirdupois pound \[kg\], exact.
const POUND: f64 = 0.453_592_37;
/// Pound-force \[N\]: a pound under standard gravity of 9.80665 m/s2, exact.
const POUND_FORCE: f64 = 4.448_221_615_260_5;
/// Standard gravity \[m/s2\], exact.
const STANDARD_GRAVITY: f64 = 9.806_65;
/// Degree \[rad\].
const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// A hundred square feet \[m2\], in which yield stresses of mud are read.
const HUNDRED_SQUARE_FEET: f64 = 100.0 * FOOT * FOOT;

/// A kind that is shown in the unit in which it is kept.
const fn units(dimension: &'static str, kept: &'static str, field: (&'static str, f64)) -> Units {
    shown_in(dimension, kept, (kept, 1.0), field)
}

const fn shown_in(
    dimension: &'static str,
    kept: &'static str,
    shown: (&'static str, f64),
    field: (&'static str, f64),
) -> Units {
    Units {
        dimension,
        kept,
        shown: Unit { symbol: shown.0, size: shown.1 },
        field: Unit { symbol: field.0, size: field.1 },
    }
}

/// Ratios, and numbers without a unit.
pub static RATIO: Units = units("ratio", "1", ("1", 1.0));
/// Times.
pub static TIME: Units = units("time", "s", ("s", 1.0));
/// Frequencies.
pub static FREQUENCY: Units = units("frequency", "Hz", ("Hz", 1.0));
/// Growth and decay of vibrations.
pub static RATE: Units = units("rate", "1/s", ("1/s", 1.0));
/// Lengths along the well and the string.
pub static DEPTH: Units = units("length", "m", ("ft", FOOT));
/// Lengths across the hole: diameters, clearances, displacements.
pub static WIDTH: Units = shown_in("length", "m", ("mm", 1e-3), ("in", INCH));
/// Areas of small openings.
pub static FLOW_AREA: Units = units("area", "m2", ("in2", INCH * INCH));
/// Wavenumbers and sharpnesses.
pub static PER_LENGTH: Units = units("reciprocal length", "1/m", ("1/in", 1.0 / INCH));
/// Speeds.
pub static SPEED: Units = units("speed", "m/s", ("ft/s", FOOT));
/// Angles.
pub static ANGLE: Units = units("angle", "rad", ("deg", DEGREE));
/// Angles that are kept in degrees, as their names say.
pub static ANGLE_IN_DEGREES: Units = units("angle", "deg", ("deg", 1.0));
/// Angular speeds.
pub static ANGULAR_SPEED: Units = units("angular speed", "rad/s", ("rpm", 6.0 * DEGREE));
/// Speeds of rotation that are kept in revolutions per minute, as their names say.
pub static SPEED_OF_ROTATION: Units = units("angular speed", "rpm", ("rpm", 1.0));
/// Masses.
pub static MASS: Units = units("mass", "kg", ("lb", POUND));
/// Masses of a length of string.
pub static MASS_PER_LENGTH: Units = units("mass per length", "kg/m", ("lb/ft", POUND / FOOT));
/// Moments of inertia.
pub static INERTIA: Units = units("moment of inertia", "kg m2", ("lb ft2", POUND * FOOT * FOOT));
/// Densities of muds.
pub static MUD_DENSITY: Units = units("density", "kg/m3", ("ppg", POUND / GALLON));
/// Densities of solids.
pub static DENSITY: Units = units("density", "kg/m3", ("lb/ft3", POUND / (FOOT * FOOT * FOOT)));
/// Flow rates.
pub static FLOW_RATE: Units = units("volume flow rate", "m3/s", ("gpm", GALLON / 60.0));
/// Forces.
pub static FORCE: Units = shown_in("force", "N", ("kN", 1e3), ("klbf", 1e3 * POUND_FORCE));
/// Torques.
pub static TORQUE: Units = shown_in("torque", "N m", ("kN m", 1e3), ("ft lbf", FOOT * POUND_FORCE));
/// Energies.
pub static ENERGY: Units = units("energy", "J", ("ft lbf", FOOT * POUND_FORCE));
/// Powers.
pub static POWER: Units = units("power", "W", ("hp", 550.0 * FOOT * POUND_FORCE));
/// Accelerations, read in multiples of standard gravity as tools downhole report them.
pub static ACCELERATION: Units =
    shown_in("acceleration", "m/s2", ("g", STANDARD_GRAVITY), ("g", STANDARD_GRAVITY));
/// Numbers of events by time, read per minute.
pub static EVENT_RATE: Units = shown_in("rate", "1/s", ("1/min", 1.0 / 60.0), ("1/min", 1.0 / 60.0));
/// Parts of a life by time, read per hour.
pub static WEAR_RATE: Units = shown_in("rate", "1/s", ("1/h", 1.0 / 3600.0), ("1/h", 1.0 / 3600.0));
/// Stresses in solids.
pub static STRESS: Units = shown_in("stress", "Pa", ("MPa", 1e6), ("ksi", 1e3 * POUND_FORCE / (INCH * INCH)));
/// Pressures.
pub static PRESSURE: Units = shown_in("pressure", "Pa", ("MPa", 1e6), ("psi", POUND_FORCE / (INCH * INCH)));
/// Moduli of solids.
pub static MODULUS: Units =
    shown_in("pressure", "Pa", ("GPa", 1e9), ("Mpsi", 1e6 * POUND_FORCE / (INCH * INCH)));
/// Pressures lost over a length.
pub static PRESSURE_GRADIENT: Units =
    units("pressure gradient", "Pa/m", ("psi/ft", POUND_FORCE / (INCH * INCH * FOOT)));
/// Yield stresses of muds.
pub static YIELD_STRESS: Units = units("stress", "Pa", ("lbf/100 ft2", POUND_FORCE / HUNDRED_SQUARE_FEET));
/// Consistencies of muds: stress over shear rate to the power of the flow index n.
pub static CONSISTENCY: Units =
    units("consistency", "Pa s^n", ("lbf s^n/100 ft2", POUND_FORCE / HUNDRED_SQUARE_FEET));
/// Kinematic viscosities.
pub static KINEMATIC_VISCOSITY: Units = units("kinematic viscosity", "m2/s", ("cSt", 1e-6));
/// Stiffnesses.
pub static STIFFNESS: Units = units("stiffness", "N/m", ("lbf/in", POUND_FORCE / INCH));
/// Stiffnesses of a length of string.
pub static STIFFNESS_PER_LENGTH: Units =
    units("stiffness per length", "N/m2", ("lbf/in2", POUND_FORCE / (INCH * INCH)));
/// Damping constants.
pub static DAMPING: Units = units("damping", "N s/m", ("lbf s/in", POUND_FORCE / INCH));
/// Damping constants of a length of string.
pub static DAMPING_PER_LENGTH: Units =
    units("damping per length", "N s/m2", ("lbf s/in2", POUND_FORCE / (INCH * INCH)));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn field_units_are_as_published() {
        // NIST Special Publication 811 (2008), appendix B.8, to all digits printed there.
        for (units, symbol, published, digits) in [
            (&DEPTH, "ft", 0.3048, 15),
            (&WIDTH, "in", 0.0254, 15),
            (&FLOW_RATE, "gpm", 6.309_020e-5, 7),
            (&MUD_DENSITY, "ppg", 119.826_4, 7),
            (&DENSITY, "lb/ft3", 16.018_46, 7),
            (&FORCE, "klbf", 4_448.221_615_260_5, 15),
            (&TORQUE, "ft lbf", 1.355_818, 7),
            (&ENERGY, "ft lbf", 1.355_818, 7),
            (&PRESSURE, "psi", 6894.757, 7),
            (&STRESS, "ksi", 6_894_757.0, 7),
            (&POWER, "hp", 745.699_9, 7),
            (&ACCELERATION, "g", 9.806_65, 15),
            (&MASS, "lb", 0.453_592_37, 15),
            (&MASS_PER_LENGTH, "lb/ft", 1.488_164, 7),
            (&INERTIA, "lb ft2", 4.214_011e-2, 7),
            (&SPEED, "ft/s", 0.3048, 15),
            (&ANGLE, "deg", 0.017_453_29, 7),
            (&ANGULAR_SPEED, "rpm", 0.104_719_8, 7),
            (&STIFFNESS, "lbf/in", 175.126_8, 7),
            (&KINEMATIC_VISCOSITY, "cSt", 1e-6, 15),
        ] {
            assert_eq!(units.field.symbol, symbol);
            let off = (units.field.size / published - 1.0).abs();
            assert!(off < 0.5 * 10_f64.powi(1 - digits), "{symbol}: {} off by {off:e}", units.field.size);
        }
    }

    #[test]
    fn symbols_are_written_with_powers_and_products() {
        let written = |units: &Units, system| units.of(system).text();
        assert_eq!(written(&DAMPING_PER_LENGTH, UnitSystem::Si), "N·s/m²");
        assert_eq!(written(&FLOW_RATE, UnitSystem::Si), "m³/s");
        assert_eq!(written(&YIELD_STRESS, UnitSystem::Field), "lbf/100·ft²");
        assert_eq!(written(&ANGLE_IN_DEGREES, UnitSystem::Si), "°");
        assert_eq!(written(&RATIO, UnitSystem::Field), "");
    }

    #[test]
    fn a_value_reads_as_engineers_expect() {
        let near = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-3, "{value}");
        near(FLOW_RATE.field.of(0.04), 634.0);
        near(MUD_DENSITY.field.of(1200.0), 10.014);
        near(FORCE.field.of(-100e3), -22.48);
        near(WIDTH.field.of(0.2159), 8.5);
        near(YIELD_STRESS.field.of(5.0), 10.443);
        near(WIDTH.shown.of(0.2159), 215.9);
    }
}
