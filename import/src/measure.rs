//! Numbers of a column with the unit of their cell, of their heading, or one that is assumed.

use drillsweep_quantity::entry;
use drillsweep_quantity::units::{DEPTH, FORCE, MASS, MASS_PER_LENGTH, STIFFNESS, TORQUE, Units, WIDTH};
use serde::Deserialize;

use crate::error::ImportError;
use crate::headings::Found;
use crate::number::number;
use crate::rows::UnderstoodColumn;

/// Units of columns that have none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AssumedUnits {
    /// Lengths in metres, diameters in millimetres, weights in kilograms a metre, forces in kilonewtons, torques in kilonewton metres.
    Si,
    /// Lengths in feet, diameters in inches, weights in pounds a foot, forces in thousand pounds, torques in foot-pounds.
    Field,
}

/// Dimension of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dimension {
    Length,
    Diameter,
    /// Mass or weight, of a length or of the whole row.
    Weight,
    /// A force, or the mass that weighs as much.
    Force,
    Torque,
    /// A number without a unit.
    Number,
}

/// A number in the unit of its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Value {
    /// Length \[m\], force \[N\], torque \[N m\], or a number without a unit.
    Plain(f64),
    /// Mass of a length \[kg/m\].
    PerLength(f64),
    /// Mass of the whole row \[kg\].
    Whole(f64),
}

impl Value {
    pub(crate) fn number(self) -> f64 {
        match self {
            Self::Plain(value) | Self::PerLength(value) | Self::Whole(value) => value,
        }
    }
}

/// Reason for which a cell has no value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Fault {
    /// Neither the cell nor its column has a unit.
    NoUnit,
    /// The fault in words.
    Cell(String),
}

/// Standard gravity \[m/s2\], by which a weight stands for a mass.
const STANDARD_GRAVITY: f64 = 9.806_65;

impl Dimension {
    fn assumed(self, units: AssumedUnits) -> &'static str {
        match (self, units) {
            (Self::Length, AssumedUnits::Si) => "m",
            (Self::Length, AssumedUnits::Field) => "ft",
            (Self::Diameter, AssumedUnits::Si) => "mm",
            (Self::Diameter, AssumedUnits::Field) => "in",
            (Self::Weight, AssumedUnits::Si) => "kg/m",
            (Self::Weight, AssumedUnits::Field) => "lb/ft",
            (Self::Force, AssumedUnits::Si) => "kN",
            (Self::Force, AssumedUnits::Field) => "klbf",
            (Self::Torque, AssumedUnits::Si) => "kN m",
            (Self::Torque, AssumedUnits::Field) => "ft lbf",
            (Self::Number, _) => "",
        }
    }

    /// Valid units, in words.
    fn valid(self) -> &'static str {
        match self {
            Self::Length => "m or ft",
            Self::Diameter => "in, mm, cm or m",
            Self::Weight => "lb/ft or kg/m of a length; lb, klbf, kg, t, N, daN or kN of the whole row",
            Self::Force => "kN, N, daN, klbf or lbf; kg, t or lb by its weight",
            Self::Torque => "kN m, N m, ft lbf or kft lbf",
            Self::Number => "none",
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Length => "a length",
            Self::Diameter => "a diameter",
            Self::Weight => "a weight",
            Self::Force => "a force",
            Self::Torque => "a torque",
            Self::Number => "a number",
        }
    }

    /// A decimal number or fraction with its unit; `None` if the unit does not fit.
    fn read(self, number: &str, unit: &str) -> Option<Value> {
        let unit = spelled(unit);
        let of = |units: &Units| entry::read(&format!("{number} {unit}"), units).ok();
        match self {
            Self::Length => of(&DEPTH).map(Value::Plain),
            Self::Diameter => of(&WIDTH).map(Value::Plain),
            Self::Weight => of(&MASS_PER_LENGTH)
                .or_else(|| of(&STIFFNESS).map(|weight| weight / STANDARD_GRAVITY))
                .map(Value::PerLength)
                .or_else(|| of(&MASS).map(Value::Whole))
                .or_else(|| of(&FORCE).map(|weight| Value::Whole(weight / STANDARD_GRAVITY))),
            Self::Force => {
                of(&FORCE).or_else(|| of(&MASS).map(|mass| mass * STANDARD_GRAVITY)).map(Value::Plain)
            }
            Self::Torque => of(&TORQUE).map(Value::Plain),
            Self::Number => unit.is_empty().then(|| number.parse().ok().map(Value::Plain)).flatten(),
        }
    }
}

/// A column of numbers, with the unit in which they were read.
pub(crate) struct Measures<'a> {
    pub(crate) found: &'a Found,
    quantity: &'static str,
    dimension: Dimension,
    assumed: Option<&'static str>,
    /// First unit in use, and true if it was assumed.
    used: Option<(String, bool)>,
}

impl<'a> Measures<'a> {
    /// A column of a quantity.
    ///
    /// # Errors
    /// The unit of its heading does not fit.
    pub(crate) fn new(
        found: &'a Found,
        quantity: &'static str,
        dimension: Dimension,
        assumed: Option<AssumedUnits>,
    ) -> Result<Self, ImportError> {
        let assumed = match dimension {
            Dimension::Number => Some(""),
            _ => assumed.map(|units| dimension.assumed(units)),
        };
        let used = found.unit.clone().filter(|_| dimension != Dimension::Number).map(|unit| (unit, false));
        match &used {
            Some((unit, _)) if dimension.read("1", unit).is_none() => Err(ImportError::Unit {
                column: found.name.clone(),
                heading: found.heading.clone(),
                quantity,
                valid: dimension.valid().to_owned(),
            }),
            _ => Ok(Self { found, quantity, dimension, assumed, used }),
        }
    }

    /// The value of a cell.
    ///
    /// # Errors
    /// It has no number, a unit that does not fit, or none at all.
    pub(crate) fn read(&mut self, text: &str, has_decimal_comma: bool) -> Result<Value, Fault> {
        if text.is_empty() {
            return Err(Fault::Cell("the cell is empty".to_owned()));
        }
        let no_number = || Fault::Cell("no number".to_owned());
        let unit_at = text
            .find(|sign: char| sign.is_alphabetic() || matches!(sign, '"' | '\'' | '″' | '′' | '#' | '%'));
        let (digits, own) = text.split_at(unit_at.unwrap_or(text.len()));
        // A fraction is read with its unit, to the last bit as a decimal number is.
        let plain = if digits.contains('/') {
            digits.trim().to_owned()
        } else {
            number(digits, has_decimal_comma).ok_or_else(no_number)?.to_string()
        };
        if self.dimension.read(&plain, self.dimension.assumed(AssumedUnits::Si)).is_none() {
            return Err(no_number());
        }
        let own = own.trim();
        let (unit, is_assumed) = match (own, &self.found.unit, self.assumed) {
            ("", Some(unit), _) if self.dimension != Dimension::Number => (unit.as_str(), false),
            ("", _, Some(unit)) => (unit, true),
            ("", ..) => return Err(Fault::NoUnit),
            (own, ..) => (own, false),
        };
        let value = self.dimension.read(&plain, unit).ok_or_else(|| {
            Fault::Cell(format!(
                "`{unit}` is no unit of {}: {}",
                self.dimension.name(),
                self.dimension.valid()
            ))
        })?;
        self.used.get_or_insert_with(|| (unit.to_owned(), is_assumed));
        Ok(value)
    }

    /// Error of a column without a unit.
    pub(crate) fn no_unit(&self) -> ImportError {
        ImportError::NoUnit {
            column: self.found.name.clone(),
            heading: self.found.heading.clone(),
            quantity: self.dimension.name(),
            valid: self.dimension.valid(),
            option: "assumed_units",
        }
    }

    /// Meaning of the column; absent if no cell of it was read.
    pub(crate) fn understood(self) -> Option<UnderstoodColumn> {
        let (unit, is_assumed) = self.used?;
        Some(UnderstoodColumn {
            quantity: self.quantity,
            column: self.found.name.clone(),
            heading: self.found.heading.clone(),
            is_assumed: is_assumed && self.dimension != Dimension::Number,
            unit,
        })
    }
}

/// A unit as the vocabulary spells it: files have `metres`, `F` of LAS, `lbs/ft`, `#`.
pub(crate) fn spelled(unit: &str) -> String {
    let unit = unit.trim().trim_end_matches('.');
    let spelled = match unit.to_lowercase().as_str() {
        "metre" | "metres" | "meter" | "meters" | "mtr" | "mtrs" => "m",
        "f" | "usft" | "ftus" | "ft[us]" => "ft",
        "ins" | "''" | "’’" => "in",
        "lbs/ft" | "lbf/ft" | "#/ft" | "#" | "lb/foot" | "lbs/foot" => "lb/ft",
        "kgf/m" | "kgs/m" | "kg/metre" | "kg/meter" => "kg/m",
        "pounds" => "lb",
        "kgs" => "kg",
        "tonne" | "tonnes" | "mt" => "t",
        "klb" | "klbs" | "kips" | "kip" => "klbf",
        "knm" | "kn.m" | "kn-m" | "kn*m" => "kN m",
        "nm" | "n.m" | "n-m" | "n*m" => "N m",
        "ft.lbf" | "ft.lb" | "ft*lbf" | "lbf.ft" | "lb.ft" | "lb-ft" | "lbf-ft" | "ft-lbs" | "ft lbs" => {
            "ft lbf"
        }
        "kft.lbf" | "kft.lb" | "klbf.ft" | "klb.ft" | "kft-lbs" | "kft lbs" | "klb-ft" | "klbf-ft" => {
            "kft lbf"
        }
        _ => unit,
    };
    spelled.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(dimension: Dimension, unit: Option<&str>, text: &str) -> Result<Value, Fault> {
        let found = Found {
            column: 0,
            name: "A".to_owned(),
            heading: "heading".to_owned(),
            unit: unit.map(str::to_owned),
        };
        Measures::new(&found, "quantity", dimension, None).unwrap().read(text, false)
    }

    #[test]
    fn a_diameter_is_the_same_double_however_it_is_written() {
        for (unit, text) in [
            (Some("in"), "12.25"),
            (Some("in"), "12 1/4"),
            (Some("\""), "12-1/4"),
            (None, "12 1/4\""),
            (None, "12.25 in"),
            (Some("mm"), "311.15"),
            (Some("mm"), "12 1/4 inch"),
            (Some("cm"), "31.115"),
            (Some("m"), "0.31115"),
        ] {
            assert_eq!(read(Dimension::Diameter, unit, text), Ok(Value::Plain(0.311_15)), "{text} {unit:?}");
        }
    }

    #[test]
    fn weights_are_those_of_a_length_or_of_the_whole_row() {
        // 19.5 lb/ft are 29.0194 kg/m; a pound is 0.45359237 kg.
        let close = |value: f64, expected: f64| (value / expected - 1.0).abs() < 1e-5;
        for unit in ["lb/ft", "lbs/ft", "ppf", "lbf/ft", "#", "LB/FT"] {
            let Ok(Value::PerLength(value)) = read(Dimension::Weight, Some(unit), "19.5") else {
                panic!("{unit}")
            };
            assert!(close(value, 29.0194), "{unit}: {value}");
        }
        for (unit, text, expected) in
            [("N/m", "284.584", 29.0194), ("kN/m", "0.284584", 29.0194), ("kgf/m", "29.0194", 29.0194)]
        {
            let read = read(Dimension::Weight, Some(unit), text);
            assert!(
                matches!(read, Ok(Value::PerLength(value)) if close(value, expected)),
                "{unit}: {read:?}"
            );
        }
        for (unit, text, expected) in [
            ("lbf", "4497", 2_039.804_9),
            ("lbs", "4,497", 2_039.804_9),
            ("klbf", "4.497", 2_039.804_9),
            ("kN", "20.0036", 2_039.804_9),
            ("t", "2.0398049", 2_039.804_9),
        ] {
            let read = read(Dimension::Weight, Some(unit), text);
            assert!(matches!(read, Ok(Value::Whole(value)) if close(value, expected)), "{unit}: {read:?}");
        }
    }

    #[test]
    fn cells_without_number_or_unit_are_faults() {
        assert_eq!(read(Dimension::Length, None, "9.3"), Err(Fault::NoUnit));
        for text in ["", "n/a", "nan", "inf", "1e999", "9.3 psi", "1/7", "12 1/4 1/4", "0x10", "--"] {
            assert!(matches!(read(Dimension::Length, Some("m"), text), Err(Fault::Cell(_))), "{text}");
        }
    }
}
