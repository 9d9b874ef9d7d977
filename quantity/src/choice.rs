//! Units in which the columns of a table are written, as a reader chooses them.

use std::collections::BTreeMap;

use crate::columns;
use crate::entry::{self, UnitError};
use crate::name::Name;
use crate::units::{self, Unit, UnitSystem, Units};

/// Units of columns: those of a system, and for some columns a unit of their own. `field,mud_density:kg/m3` is the oil field's, with densities
/// of mud in SI.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct UnitChoice {
    /// System of the columns that are not named; absent means the units in which they are kept.
    system: Option<UnitSystem>,
    /// Symbols by name of a column, or of a quantity for all its columns.
    named: BTreeMap<String, &'static str>,
}

/// Reason why units cannot be chosen: the valid texts, as in "must be ...".
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ChoiceError {
    /// It is no system, and no column with a unit.
    #[error("si or field, or columns with a unit each, such as field,mud_density:kg/m3")]
    Form,
    /// The vocabulary has no such column with a unit.
    #[error("si or field, or columns with a unit each; no column with a unit has the name {0}")]
    Column(String),
    /// The unit is none of the column.
    #[error("for {column} one of the units {error}")]
    Unit {
        /// The column.
        column: String,
        /// Units that fit.
        error: UnitError,
    },
    /// There are too many.
    #[error("at most {MOST_NAMED} columns with a unit")]
    TooMany,
}

/// Largest number of columns that have a unit of their own.
const MOST_NAMED: usize = 64;

/// Longest name of a column in a message \[characters\].
const LONGEST: usize = 80;

impl From<UnitSystem> for UnitChoice {
    fn from(system: UnitSystem) -> Self {
        Self { system: Some(system), named: BTreeMap::new() }
    }
}

impl UnitChoice {
    /// A choice from its text: `si`, `field`, and `COLUMN:UNIT`, separated by commas.
    ///
    /// # Errors
    /// A part is neither, names no column with a unit, or a unit of another dimension.
    pub fn parse(text: &str) -> Result<Self, ChoiceError> {
        let mut choice = Self::default();
        for part in text.split(',').map(str::trim) {
            let Some((name, symbol)) = part.split_once(':') else {
                let system = match part {
                    "si" => UnitSystem::Si,
                    "field" => UnitSystem::Field,
                    _ => return Err(ChoiceError::Form),
                };
                if choice.system.replace(system).is_some() {
                    return Err(ChoiceError::Form);
                }
                continue;
            };
            if choice.named.len() == MOST_NAMED {
                return Err(ChoiceError::TooMany);
            }
            let name = name.trim();
            let column: String = name.chars().take(LONGEST).collect();
            let Some(units) = Name::parse(name).and_then(|name| name.units()) else {
                return Err(ChoiceError::Column(column));
            };
            let unit = entry::unit_of(symbol, units).map_err(|error| ChoiceError::Unit { column, error })?;
            choice.named.insert(name.to_owned(), unit.symbol);
        }
        Ok(choice)
    }

    /// True if all columns stay in the units in which they are kept.
    pub fn is_kept(&self) -> bool {
        *self == Self::default()
    }

    /// Text of the choice for names of files: its system, or `units`; absent if columns stay as they are kept.
    pub fn suffix(&self) -> Option<&'static str> {
        match self.system {
            _ if self.is_kept() => None,
            Some(UnitSystem::Si) if self.named.is_empty() => Some("si"),
            Some(UnitSystem::Field) if self.named.is_empty() => Some("field"),
            _ => Some("units"),
        }
    }

    /// The unit in which a table has a column, by its name; absent for columns without a unit.
    pub fn unit(&self, column: &str) -> Option<Unit> {
        let name = Name::parse(column)?;
        let units = name.units()?;
        let kept = Unit { symbol: units.kept, size: 1.0 };
        Some(self.named(column).unwrap_or_else(|| match self.system {
            // Sizes of the entries are the exact ones to the last bit.
            Some(system) => {
                entry::unit_of(units.of(system).symbol, units).unwrap_or_else(|_| units.of(system))
            }
            None => kept,
        }))
    }

    /// The unit in which a picture shows a column, by its name; absent for ratios and columns without a unit. Without a system it is that of SI.
    pub fn shown(&self, column: &str) -> Option<Unit> {
        let units = Name::parse(column)?.units()?;
        let usual = Some(self.usual(units)).filter(|_| units != &units::RATIO);
        self.named(column).or(usual)
    }

    /// The unit in which pictures show a kind of quantity.
    pub fn usual(&self, units: &Units) -> Unit {
        units.of(self.system.unwrap_or_default())
    }

    /// The unit in which pictures show depths.
    pub fn depth(&self) -> Unit {
        self.shown(columns::MEASURED_DEPTH.name).unwrap_or(units::DEPTH.shown)
    }

    /// The unit that a column has by its own name, or that of its quantity.
    pub fn named(&self, column: &str) -> Option<Unit> {
        if self.named.is_empty() {
            return None;
        }
        let name = Name::parse(column)?;
        let symbol = self.named.get(column).or_else(|| self.named.get(name.quantity.name))?;
        // A bias of the quantity is a ratio, which its unit does not fit.
        entry::unit_of(symbol, name.units()?).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symbol(choice: &str, column: &str) -> Option<&'static str> {
        UnitChoice::parse(choice).unwrap().unit(column).map(|unit| unit.symbol)
    }

    #[test]
    fn columns_have_the_unit_of_the_system_or_their_own() {
        for (choice, column, unit) in [
            ("field", "mud_density", Some("ppg")),
            ("field,mud_density:kg/m3", "mud_density", Some("kg/m3")),
            ("field, mud_density : kg/m3", "flow_rate", Some("gpm")),
            ("mud_density:lb/gal", "mud_density", Some("ppg")),
            ("mud_density:ppg", "flow_rate", Some("m3/s")),
            ("si", "u_49", Some("mm")),
            ("field,u:mm,u_12:m", "u_49", Some("mm")),
            ("field,u:mm,u_12:m", "u_12", Some("m")),
            ("field,orbit_radius_rms:mm", "bias_orbit_radius_rms_49", Some("1")),
            ("field,orbit_radius_rms:mm", "spread_orbit_radius_rms_49", Some("mm")),
            ("string.sections.length:m", "string.sections[2].length", Some("m")),
            ("field", "string.sections[2].length", Some("ft")),
            ("field", "node", None),
            ("field", "nothing", None),
        ] {
            assert_eq!(symbol(choice, column), unit, "{choice}: {column}");
        }
        assert_eq!(UnitChoice::default().unit("u_49").map(|unit| unit.symbol), Some("m"));
    }

    #[test]
    fn choices_that_differ_in_spelling_are_equal() {
        let parsed = |text: &str| UnitChoice::parse(text).unwrap();
        assert_eq!(parsed("field,mud_density:lb/gal,u:MM"), parsed("u:mm,mud_density:ppg,field"));
        assert_eq!(
            ["si", "field", "field,u:mm", "u:mm"].map(|text| parsed(text).suffix().unwrap()),
            ["si", "field", "units", "units"]
        );
        assert_eq!(UnitChoice::default().suffix(), None);
    }

    #[test]
    fn units_that_do_not_fit_are_refused_with_those_that_do() {
        let refused = |text: &str| UnitChoice::parse(text).unwrap_err().to_string();
        assert_eq!(
            refused("field,mud_density:gpm"),
            "for mud_density one of the units kg/m3, g/cm3, ppg, lb/ft3; `gpm` is a unit of volume flow rate"
        );
        assert_eq!(
            refused("mud_densty:ppg"),
            "si or field, or columns with a unit each; no column with a unit has the name mud_densty"
        );
        assert!(refused("node:m").contains("the name node"));
        for text in ["", "metric", "si,field", "field,,", "mud_density"] {
            assert_eq!(UnitChoice::parse(text), Err(ChoiceError::Form), "{text}");
        }
        let many: Vec<String> = (0..=MOST_NAMED).map(|node| format!("u_{node}:mm")).collect();
        assert_eq!(UnitChoice::parse(&many.join(",")), Err(ChoiceError::TooMany));
    }
}
