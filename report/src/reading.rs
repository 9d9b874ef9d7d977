//! Names and values as readers see them.

use drillsweep_quantity::{Name, Unit, UnitSystem, units};
use serde_json::Value;

/// Significant digits of a value.
const DIGITS: usize = 4;

/// Between thousands: a narrow space at which no line breaks.
const THOUSANDS: char = '\u{202f}';

/// Missing value.
pub(crate) const NONE: &str = "–";

/// Name of a column or of a scenario's field, in words.
pub(crate) fn words(name: &str) -> String {
    match Name::parse(name) {
        Some(known) => known.to_string(),
        None => name.rsplit('.').next().unwrap_or(name).replace('_', " "),
    }
}

/// Unit in which readers of a system read a name; none of ratios, texts and numbers of things.
pub(crate) fn unit(name: &str, system: UnitSystem) -> Option<Unit> {
    Name::parse(name)?.units().filter(|units| *units != &units::RATIO).map(|units| units.of(system))
}

/// A value of a name with its unit.
pub(crate) fn amount(name: &str, value: f64, system: UnitSystem) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    match unit(name, system) {
        Some(unit) => {
            let symbol = unit.text();
            let space = if symbol == "°" { "" } else { "\u{a0}" };
            format!("{}{space}{symbol}", number(unit.of(value)))
        }
        None => number(value),
    }
}

/// A JSON value of a name with its unit; texts are words.
pub(crate) fn said(name: &str, value: &Value, system: UnitSystem) -> String {
    match value {
        Value::Number(number) => number.as_f64().map_or(NONE.to_owned(), |value| amount(name, value, system)),
        Value::String(text) => text.replace('_', " "),
        Value::Bool(true) => "yes".to_owned(),
        Value::Bool(false) => "no".to_owned(),
        _ => NONE.to_owned(),
    }
}

/// A part in per cent.
pub(crate) fn percent(part: f64) -> String {
    format!("{}\u{a0}%", number(100.0 * part))
}

/// A number to four significant digits; from five digits before the point on, thousands stand apart.
pub(crate) fn number(value: f64) -> String {
    // Without the sign of a negative zero.
    let value = value + 0.0;
    let size = value.abs();
    let text = if value.fract() == 0.0 && size < 1e6 {
        format!("{value}")
    } else if !(1e-3..1e9).contains(&size) {
        return format!("{value:.*e}", DIGITS - 1).replace('-', "−");
    } else {
        let rounded: f64 = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
        format!("{rounded}")
    };
    grouped(&text).replace('-', "−")
}

fn grouped(text: &str) -> String {
    let (whole, part) = text.split_once('.').map_or((text, None), |(whole, part)| (whole, Some(part)));
    let (sign, digits) = whole.strip_prefix('-').map_or(("", whole), |digits| ("-", digits));
    if digits.len() < 5 {
        return text.to_owned();
    }
    let mut apart = sign.to_owned();
    for (place, digit) in digits.char_indices() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            apart.push(THOUSANDS);
        }
        apart.push(digit);
    }
    match part {
        Some(part) => format!("{apart}.{part}"),
        None => apart,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (-3.0, "−3"),
            (9999.0, "9999"),
            (999_999.0, "999\u{202f}999"),
            (-12_345.67, "−12\u{202f}350"),
            (12.345_6, "12.35"),
            (0.012_346, "0.01235"),
            (0.000_123_46, "1.235e−4"),
            (1e7, "10\u{202f}000\u{202f}000"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn values_have_the_units_of_the_chosen_system() {
        let field = UnitSystem::Field;
        // NIST SP 811: 119.8264 kg/m3 a ppg, 25.4 mm an inch, 4448.222 N a klbf.
        for (name, value, si, oil) in [
            ("mud.density", 1198.264, "1198\u{a0}kg/m³", "10\u{a0}ppg"),
            ("well.hole_diameter", 0.2159, "215.9\u{a0}mm", "8.5\u{a0}in"),
            ("operation.weight_on_bit", -100e3, "−100\u{a0}kN", "−22.48\u{a0}klbf"),
            ("well.survey.inclination_deg", 60.0, "60°", "60°"),
            ("contact.static_friction", 0.3, "0.3", "0.3"),
        ] {
            assert_eq!(
                (amount(name, value, UnitSystem::Si).as_str(), amount(name, value, field).as_str()),
                (si, oil)
            );
        }
    }
}
