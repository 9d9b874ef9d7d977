//! Numbers with their units as people write them, such as `10.5 ppg`, `12 1/4 in` or `2.5 klbf`, read exactly: the result is the double
//! nearest to the number in the unit in which its quantity is kept, so that `215.9 mm` and `8 1/2 in` are 0.2159 m to the last bit.

use std::collections::HashMap;
use std::sync::LazyLock;

use bigdecimal::{BigDecimal, Zero};
use thiserror::Error;

use crate::units::{Unit, Units};

/// Longest text of an entry \[bytes\].
const LONGEST: usize = 60;

/// Reads a number with its unit, in the unit in which its quantity is kept.
///
/// # Errors
/// A text without a number or without a unit, or one of another dimension.
pub fn read(text: &str, units: &Units) -> Result<f64, EntryError> {
    let malformed = || EntryError::Number { fits: fitting(units) };
    if text.len() > LONGEST {
        return Err(malformed());
    }
    let (number, symbol) = number(text.trim()).ok_or_else(malformed)?;
    if symbol.is_empty() {
        return Err(malformed());
    }
    let (_, factor) = find(symbol, units)?;
    let value: f64 = (number * factor).to_scientific_notation().parse().map_err(|_| malformed())?;
    if value.is_finite() { Ok(value) } else { Err(EntryError::Size) }
}

/// The unit of a symbol in which a quantity may be written, with its exact size as the nearest double.
///
/// # Errors
/// The symbol is unknown, or of a unit of another dimension.
pub fn unit_of(symbol: &str, units: &Units) -> Result<Unit, UnitError> {
    let (entry, factor) = find(symbol.trim(), units)?;
    let usual = entry.symbols[0];
    // The vocabulary may write the symbol with blanks.
    let own = [units.kept, units.shown.symbol, units.field.symbol];
    let symbol = own.into_iter().find(|own| plain(own) == plain(usual)).unwrap_or(usual);
    let size = factor.to_scientific_notation().parse().map_err(|_| UnitError::unknown(symbol, units))?;
    Ok(Unit { symbol, size })
}

fn find(symbol: &str, units: &Units) -> Result<(&'static Entry, &'static BigDecimal), UnitError> {
    let unit = Family::of(units).and_then(|family| family.find(symbol));
    let found = unit.and_then(|unit| Some((unit, FACTORS.get(&(unit.symbols[0], units.kept))?)));
    found.ok_or_else(|| UnitError::unknown(symbol, units))
}

/// Sizes of all units in the others of their family, by both symbols, to a hundred digits. A division takes tens of microseconds, and a
/// request may have millions of texts.
static FACTORS: LazyLock<HashMap<(&str, &str), BigDecimal>> = LazyLock::new(|| {
    let pairs = FAMILIES.iter().flat_map(|family| {
        family.units.iter().flat_map(|unit| family.units.iter().map(move |kept| (unit, kept)))
    });
    pairs.map(|(unit, kept)| ((unit.symbols[0], kept.symbols[0]), unit.in_units_of(kept))).collect()
});

/// Reason why a text is no number of a quantity: the valid texts, as in "must be ...".
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum EntryError {
    /// It has no number, or no unit.
    #[error("a number, or a text of a number with one of the units {fits}")]
    Number {
        /// Units of the quantity.
        fits: String,
    },
    /// It is beyond the largest double.
    #[error("a finite number in its unit")]
    Size,
    /// Its unit is unknown, or of another dimension.
    #[error("a number with one of the units {0}")]
    Unit(#[from] UnitError),
}

/// Reason why a unit is none of a quantity: the valid units, as in "must be one of ...".
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{fits}{}", of_other(symbol, *dimension))]
pub struct UnitError {
    /// The unit as it was written.
    pub symbol: String,
    /// The dimension that has this unit; absent if the unit is unknown.
    pub dimension: Option<&'static str>,
    /// Units of the quantity.
    pub fits: String,
}

impl UnitError {
    fn unknown(symbol: &str, units: &Units) -> Self {
        let dimension = FAMILIES.iter().find_map(|family| family.find(symbol).map(|_| family.dimension));
        let symbol = symbol.chars().take(LONGEST).collect();
        Self { symbol, dimension, fits: fitting(units) }
    }
}

fn of_other(symbol: &str, dimension: Option<&str>) -> String {
    dimension.map_or_else(
        || format!("; `{symbol}` is unknown"),
        |dimension| format!("; `{symbol}` is a unit of {dimension}"),
    )
}

/// True if a text about a valid value is that of an [`EntryError`], which reports it through errors of other formats.
pub fn is_refusal(message: &str) -> bool {
    message.contains("a number with one of the units ") || message.ends_with("a finite number in its unit")
}

/// Symbols of the units in which a quantity may be written, the one in which it is kept first.
fn symbols(units: &Units) -> Vec<&'static str> {
    let others = Family::of(units).map_or(&[][..], |family| family.units).iter().map(|unit| unit.symbols[0]);
    [units.kept].into_iter().chain(others.filter(|symbol| *symbol != units.kept)).collect()
}

fn fitting(units: &Units) -> String {
    symbols(units).join(", ")
}

/// The number at the start of a text, decimal or with a fraction (`12 1/4`), and the rest without blanks around it.
fn number(text: &str) -> Option<(BigDecimal, &str)> {
    let (decimal, rest) = text.split_at(decimal_length(text));
    let whole: BigDecimal = decimal.parse().ok()?;
    if let Some((part, rest)) = fraction(rest.trim_start_matches([' ', '-'])) {
        let is_whole = decimal.bytes().all(|byte| byte.is_ascii_digit());
        return is_whole.then(|| (whole + part, rest));
    }
    // A fraction without a whole number before it: `3/4 in`.
    fraction(text).or_else(|| Some((whole, rest.trim())))
}

/// A fraction at the start of a text, of a half to sixty-fourths, and the rest.
fn fraction(text: &str) -> Option<(BigDecimal, &str)> {
    let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let (numerator, rest) = text.split_at(digits(text));
    let rest = rest.strip_prefix('/')?;
    let (denominator, rest) = rest.split_at(digits(rest));
    let part = PARTS.iter().find(|(parts, _)| *parts == denominator).map(|(_, part)| *part)?;
    let (numerator, part): (BigDecimal, BigDecimal) = (numerator.parse().ok()?, part.parse().ok()?);
    Some((numerator * part, rest.trim()))
}

/// Denominators of fractions, as on rulers, with the part that each stands for.
const PARTS: [(&str, &str); 6] =
    [("2", "0.5"), ("4", "0.25"), ("8", "0.125"), ("16", "0.0625"), ("32", "0.03125"), ("64", "0.015625")];

/// Length of the decimal number at the start of a text: sign, digits, point, and an exponent of at most three digits.
fn decimal_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let signed = |from: usize| from + usize::from(matches!(bytes.get(from), Some(b'+' | b'-')));
    let mut end = signed(0);
    end += digits(end);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let start = signed(end + 1);
        let length = digits(start);
        if (1..=3).contains(&length) {
            return start + length;
        }
    }
    end
}

/// A unit: its symbols, the usual one first, and its size in the first unit of its family as an exact quotient.
struct Entry {
    symbols: &'static [&'static str],
    size: (&'static str, &'static str),
}

impl Entry {
    /// Size in units of another one.
    fn in_units_of(&self, kept: &Entry) -> BigDecimal {
        let exact = |text: &str| text.parse().unwrap_or_else(|_| BigDecimal::zero());
        let numerator: BigDecimal = exact(self.size.0) * exact(kept.size.1);
        let denominator: BigDecimal = exact(self.size.1) * exact(kept.size.0);
        numerator / denominator
    }
}

/// Units of one dimension.
struct Family {
    dimension: &'static str,
    units: &'static [Entry],
}

impl Family {
    /// The family of a quantity, which has the unit in which that is kept.
    fn of(units: &Units) -> Option<&'static Family> {
        FAMILIES.iter().find(|family| family.units.iter().any(|unit| unit.symbols[0] == units.kept))
    }

    /// The unit of a symbol, whatever its blanks and signs of products and powers; in other case if only one unit is written so.
    fn find(&self, symbol: &str) -> Option<&'static Entry> {
        let plain = plain(symbol);
        let all =
            || self.units.iter().flat_map(|unit| unit.symbols.iter().map(move |symbol| (unit, *symbol)));
        let exact = all().find(|(_, symbol)| self::plain(symbol) == plain);
        let mut like = all().filter(|(_, symbol)| self::plain(symbol).eq_ignore_ascii_case(&plain));
        let unit = exact
            .or_else(|| like.next().filter(|(unit, _)| like.all(|(other, _)| std::ptr::eq(*unit, other))));
        unit.map(|(unit, _)| unit)
    }
}

/// A symbol without blanks and signs of products and powers.
fn plain(symbol: &str) -> String {
    let mut text = String::new();
    for sign in symbol.chars() {
        match sign {
            ' ' | '\u{a0}' | '\u{202f}' | '·' | '⋅' | '*' | '^' => {}
            '²' => text.push('2'),
            '³' => text.push('3'),
            '°' => text.push_str("deg"),
            '"' | '″' => text.push_str("in"),
            '\'' | '′' => text.push_str("ft"),
            'µ' => text.push('μ'),
            sign => text.push(sign),
        }
    }
    text
}

const fn unit(symbols: &'static [&'static str], size: &'static str) -> Entry {
    Entry { symbols, size: (size, "1") }
}

const fn quotient(
    symbols: &'static [&'static str],
    numerator: &'static str,
    denominator: &'static str,
) -> Entry {
    Entry { symbols, size: (numerator, denominator) }
}

/// All units. Sizes are exact by definition (NIST Special Publication 811 (2008), appendix B; the international foot and avoirdupois pound of
/// 1959; standard gravity of 9.80665 m/s2; the US gallon of 231 cubic inches and the barrel of 42 gallons), those with pi to 40 digits. A specific
/// gravity of mud is relative to 1,000 kg/m3.
static FAMILIES: &[Family] = &[
    Family { dimension: "ratio", units: &[unit(&["1"], "1"), unit(&["%"], "0.01")] },
    Family {
        dimension: "time",
        units: &[
            unit(&["s", "sec"], "1"),
            unit(&["ms"], "0.001"),
            unit(&["min"], "60"),
            unit(&["h", "hr"], "3600"),
        ],
    },
    Family { dimension: "frequency", units: &[unit(&["Hz"], "1"), unit(&["kHz"], "1000")] },
    Family {
        dimension: "rate",
        units: &[unit(&["1/s"], "1"), quotient(&["1/min"], "1", "60"), quotient(&["1/h"], "1", "3600")],
    },
    Family {
        dimension: "length",
        units: &[
            unit(&["m"], "1"),
            unit(&["mm"], "0.001"),
            unit(&["cm"], "0.01"),
            unit(&["km"], "1000"),
            unit(&["in", "inch", "inches"], "0.0254"),
            unit(&["ft", "feet", "foot"], "0.3048"),
        ],
    },
    Family {
        dimension: "area",
        units: &[
            unit(&["m2"], "1"),
            unit(&["mm2"], "0.000001"),
            unit(&["cm2"], "0.0001"),
            unit(&["in2"], "0.00064516"),
        ],
    },
    Family {
        dimension: "reciprocal length",
        units: &[
            unit(&["1/m"], "1"),
            unit(&["1/mm"], "1000"),
            quotient(&["1/in"], "1", "0.0254"),
            quotient(&["1/ft"], "1", "0.3048"),
        ],
    },
    Family {
        dimension: "speed",
        units: &[
            unit(&["m/s"], "1"),
            unit(&["mm/s"], "0.001"),
            quotient(&["m/min"], "1", "60"),
            quotient(&["m/h", "m/hr"], "1", "3600"),
            unit(&["ft/s"], "0.3048"),
            quotient(&["ft/min"], "0.3048", "60"),
            quotient(&["ft/h", "ft/hr"], "0.3048", "3600"),
        ],
    },
    Family {
        dimension: "acceleration",
        units: &[unit(&["m/s2"], "1"), unit(&["g"], "9.80665"), unit(&["ft/s2"], "0.3048")],
    },
    Family {
        dimension: "angle",
        units: &[unit(&["deg"], "1"), quotient(&["rad"], "180", "3.141592653589793238462643383279502884197")],
    },
    Family {
        dimension: "angular speed",
        units: &[
            unit(&["rpm", "rev/min", "r/min"], "1"),
            quotient(&["rad/s"], "30", "3.141592653589793238462643383279502884197"),
            quotient(&["deg/s"], "1", "6"),
            unit(&["rev/s"], "60"),
        ],
    },
    Family {
        dimension: "mass",
        units: &[
            unit(&["kg"], "1"),
            unit(&["g"], "0.001"),
            unit(&["t"], "1000"),
            unit(&["lb", "lbm", "lbs"], "0.45359237"),
        ],
    },
    Family {
        dimension: "mass per length",
        units: &[unit(&["kg/m"], "1"), quotient(&["lb/ft", "lbm/ft", "ppf"], "0.45359237", "0.3048")],
    },
    Family {
        dimension: "moment of inertia",
        units: &[unit(&["kg m2"], "1"), unit(&["lb ft2", "lbm ft2"], "0.0421401100938048")],
    },
    Family {
        dimension: "density",
        units: &[
            unit(&["kg/m3"], "1"),
            unit(&["g/cm3", "g/cc", "kg/l", "sg"], "1000"),
            quotient(&["ppg", "lb/gal", "lbm/gal"], "0.45359237", "0.003785411784"),
            quotient(&["lb/ft3", "lbm/ft3", "pcf"], "0.45359237", "0.028316846592"),
        ],
    },
    Family {
        dimension: "volume flow rate",
        units: &[
            unit(&["m3/s"], "1"),
            quotient(&["m3/min"], "1", "60"),
            quotient(&["m3/h", "m3/hr"], "1", "3600"),
            unit(&["l/s"], "0.001"),
            quotient(&["l/min", "lpm"], "0.001", "60"),
            quotient(&["gpm", "gal/min"], "0.003785411784", "60"),
            quotient(&["bbl/min", "bpm"], "0.158987294928", "60"),
        ],
    },
    Family {
        dimension: "force",
        units: &[
            unit(&["N"], "1"),
            unit(&["daN"], "10"),
            unit(&["kN"], "1000"),
            unit(&["MN"], "1000000"),
            unit(&["lbf"], "4.4482216152605"),
            unit(&["klbf", "klb", "klbs", "kip", "kips"], "4448.2216152605"),
            unit(&["kgf"], "9.80665"),
            unit(&["tf"], "9806.65"),
        ],
    },
    Family {
        dimension: "torque",
        units: &[
            unit(&["N m"], "1"),
            unit(&["daN m"], "10"),
            unit(&["kN m"], "1000"),
            unit(&["ft lbf", "lbf ft", "ft lb", "lb ft", "ft-lbf", "ft-lb"], "1.3558179483314004"),
            unit(&["kft lbf", "klbf ft", "kft lb", "kft-lbf", "kft-lb"], "1355.8179483314004"),
            unit(&["in lbf", "lbf in"], "0.1129848290276167"),
        ],
    },
    Family {
        dimension: "energy",
        units: &[
            unit(&["J"], "1"),
            unit(&["kJ"], "1000"),
            unit(&["MJ"], "1000000"),
            unit(&["ft lbf", "ft lb", "ft-lbf", "ft-lb"], "1.3558179483314004"),
        ],
    },
    Family {
        dimension: "power",
        units: &[
            unit(&["W"], "1"),
            unit(&["kW"], "1000"),
            unit(&["hp"], "745.69987158227022"),
            quotient(&["ft lbf/min", "ft-lbf/min"], "1.3558179483314004", "60"),
        ],
    },
    Family {
        dimension: "kinematic viscosity",
        units: &[unit(&["m2/s"], "1"), unit(&["mm2/s"], "0.000001"), unit(&["cSt"], "0.000001")],
    },
    Family {
        dimension: "pressure",
        units: &[
            unit(&["Pa"], "1"),
            unit(&["kPa"], "1000"),
            unit(&["MPa"], "1000000"),
            unit(&["GPa"], "1000000000"),
            unit(&["bar"], "100000"),
            quotient(&["psi", "lbf/in2"], "4.4482216152605", "0.00064516"),
            quotient(&["ksi"], "4448.2216152605", "0.00064516"),
            quotient(&["Mpsi"], "4448221.6152605", "0.00064516"),
            quotient(&["lbf/100ft2", "lb/100ft2"], "4.4482216152605", "9.290304"),
        ],
    },
    Family {
        dimension: "pressure gradient",
        units: &[
            unit(&["Pa/m"], "1"),
            unit(&["kPa/m"], "1000"),
            unit(&["bar/m"], "100000"),
            quotient(&["psi/ft"], "4.4482216152605", "0.000196644768"),
        ],
    },
    Family {
        dimension: "consistency",
        units: &[
            unit(&["Pa s^n"], "1"),
            unit(&["mPa s^n"], "0.001"),
            quotient(&["lbf s^n/100ft2", "lb s^n/100ft2"], "4.4482216152605", "9.290304"),
        ],
    },
    Family {
        dimension: "stiffness",
        units: &[
            unit(&["N/m"], "1"),
            unit(&["kN/m"], "1000"),
            unit(&["MN/m"], "1000000"),
            quotient(&["lbf/in"], "4.4482216152605", "0.0254"),
            quotient(&["lbf/ft"], "4.4482216152605", "0.3048"),
        ],
    },
    Family {
        dimension: "stiffness per length",
        units: &[
            unit(&["N/m2"], "1"),
            unit(&["kN/m2"], "1000"),
            unit(&["MN/m2"], "1000000"),
            quotient(&["lbf/in2"], "4.4482216152605", "0.00064516"),
        ],
    },
    Family {
        dimension: "damping",
        units: &[
            unit(&["N s/m"], "1"),
            unit(&["kN s/m"], "1000"),
            quotient(&["lbf s/in"], "4.4482216152605", "0.0254"),
        ],
    },
    Family {
        dimension: "damping per length",
        units: &[
            unit(&["N s/m2"], "1"),
            unit(&["kN s/m2"], "1000"),
            quotient(&["lbf s/in2"], "4.4482216152605", "0.00064516"),
        ],
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::all::all;
    use crate::units::{
        ACCELERATION, ANGLE_IN_DEGREES, DEPTH, FLOW_RATE, FORCE, MUD_DENSITY, RATIO, SPEED_OF_ROTATION,
        TORQUE, UnitSystem, WIDTH, YIELD_STRESS,
    };

    #[test]
    fn numbers_with_units_are_the_nearest_doubles_of_the_kept_unit() {
        // Products and quotients of the defined sizes by hand, to all digits.
        for (text, units, expected) in [
            ("215.9 mm", &WIDTH, 0.2159),
            ("8 1/2 in", &WIDTH, 0.2159),
            ("12 1/4 in", &WIDTH, 0.31115),
            ("12-1/4\"", &WIDTH, 0.31115),
            ("3/4in", &WIDTH, 0.01905),
            ("-0.5 ft", &WIDTH, -0.1524),
            ("30klbf", &FORCE, 133_446.648_457_815),
            ("-250 kN", &FORCE, -250_000.0),
            ("1e2 daN", &FORCE, 1_000.0),
            ("500 gpm", &FLOW_RATE, 0.031_545_098_2),
            ("1893 l/min", &FLOW_RATE, 0.031_55),
            ("2.65 sg", &MUD_DENSITY, 2_650.0),
            ("1.2 g/cm³", &MUD_DENSITY, 1_200.0),
            ("10000 ft·lbf", &TORQUE, 13_558.179_483_314_004),
            ("20 kft-lb", &TORQUE, 27_116.358_966_628_01),
            ("0.25 rev/s", &SPEED_OF_ROTATION, 15.0),
            ("3 g", &ACCELERATION, 29.419_95),
            ("30°", &ANGLE_IN_DEGREES, 30.0),
            ("5 %", &RATIO, 0.05),
        ] {
            assert_eq!(read(text, units), Ok(expected), "{text}");
        }
        // NIST SP 811 has seven digits of these.
        for (text, units, published) in [
            ("1 ppg", &MUD_DENSITY, 119.826_4),
            ("1 gpm", &FLOW_RATE, 6.309_020e-5),
            ("1 lbf/100 ft2", &YIELD_STRESS, 0.478_802_6),
            ("1 rad/s", &SPEED_OF_ROTATION, 9.549_297),
        ] {
            let read = read(text, units).unwrap();
            assert!((read / published - 1.0).abs() < 5e-7, "{text}: {read}");
        }
    }

    #[test]
    fn units_of_all_quantities_are_read_by_the_sizes_of_the_vocabulary() {
        for quantity in all() {
            let Some(units) = quantity.units else { continue };
            assert_eq!(read(&format!("0.1 {}", units.kept), units), Ok(0.1), "{}", quantity.name);
            for unit in [units.shown, units.field] {
                let (text, value) = (format!("3 {}", unit.symbol), 3.0 * unit.size);
                let read =
                    read(&text, units).unwrap_or_else(|error| panic!("{}: {text}: {error}", quantity.name));
                // The sizes of the vocabulary are rounded, and so is their product.
                assert!((read / value - 1.0).abs() < 3.0 * f64::EPSILON, "{text}: {read} is not {value}");
            }
        }
    }

    #[test]
    fn a_number_of_any_unit_is_written_as_it_was_read() {
        let texts = ["10.5", "0.1", "-22", "12.25", "1e-6", "634.012345678901", "9.99999999999999e5", "0"];
        for quantity in all() {
            let Some(units) = quantity.units else { continue };
            for symbol in symbols(units) {
                let unit = unit_of(symbol, units).unwrap();
                for text in texts {
                    let number: f64 = text.parse().unwrap();
                    let kept = read(&format!("{text} {symbol}"), units).unwrap();
                    assert_eq!(unit.written(kept), number, "{}: {text} {symbol}", quantity.name);
                }
            }
        }
    }

    #[test]
    fn a_written_number_is_the_kept_one_to_rounding() {
        // Fractions of pi, which have no short digits in any unit.
        for (units, system) in
            [(&DEPTH, UnitSystem::Field), (&FORCE, UnitSystem::Si), (&TORQUE, UnitSystem::Field)]
        {
            let unit = unit_of(units.of(system).symbol, units).unwrap();
            for number in (1..1000).map(|number| f64::from(number) * std::f64::consts::PI * 1e-3) {
                let back = unit.written(number) * unit.size;
                assert!((back / number - 1.0).abs() < 4.0 * f64::EPSILON, "{number}");
            }
        }
        let feet = unit_of("ft", &DEPTH).unwrap();
        assert!(feet.written(f64::NAN).is_nan() && feet.written(f64::INFINITY).is_infinite());
        assert_eq!(feet.written(0.3048e-300), 1e-300);
    }

    #[test]
    fn units_of_a_quantity_are_found_by_any_of_their_symbols() {
        let symbol = |symbol: &str, units: &Units| unit_of(symbol, units).map(|unit| unit.symbol);
        assert_eq!(symbol("lb/gal", &MUD_DENSITY), Ok("ppg"));
        assert_eq!(symbol("lbf/100ft2", &YIELD_STRESS), Ok("lbf/100 ft2"));
        assert_eq!(unit_of("m", &WIDTH), Ok(Unit { symbol: "m", size: 1.0 }));
        let refused = symbol("gpm", &MUD_DENSITY).unwrap_err().to_string();
        assert_eq!(refused, "kg/m3, g/cm3, ppg, lb/ft3; `gpm` is a unit of volume flow rate");
    }

    #[test]
    fn symbols_are_unambiguous_within_a_dimension() {
        for family in FAMILIES {
            for unit in family.units {
                for symbol in unit.symbols {
                    assert!(family.find(symbol).is_some_and(|found| std::ptr::eq(found, unit)), "{symbol}");
                }
                let factor = &FACTORS[&(unit.symbols[0], unit.symbols[0])];
                assert_eq!(*factor, BigDecimal::from(1), "{}", unit.symbols[0]);
            }
        }
    }

    #[test]
    fn texts_of_other_dimensions_and_without_unit_are_refused_with_units_that_fit() {
        let refused = |text: &str| read(text, &MUD_DENSITY).unwrap_err().to_string();
        let fits = "kg/m3, g/cm3, ppg, lb/ft3";
        assert_eq!(
            refused("12 gpm"),
            format!("a number with one of the units {fits}; `gpm` is a unit of volume flow rate")
        );
        assert_eq!(
            refused("12 furlongs"),
            format!("a number with one of the units {fits}; `furlongs` is unknown")
        );
        let long = "9".repeat(100) + " ppg";
        for text in [
            "",
            "ppg",
            "12",
            "steel",
            "1,5 ppg ",
            "1.5/2 ppg",
            "1/0 ppg",
            "1/3 ppg",
            "--1 ppg",
            "nan ppg",
            &long,
        ] {
            let message = refused(text);
            assert!(message.contains(fits) && is_refusal(&message), "{text}: {message}");
        }
        assert_eq!(read("1e999 ppg", &MUD_DENSITY), Err(EntryError::Size));
        assert!(is_refusal(&EntryError::Size.to_string()) && !is_refusal("a number"));
    }
}
