//! Limits of columns, from which a point is judged.

use std::collections::BTreeMap;

use drillsweep_quantity::columns::*;
use drillsweep_quantity::entry::{self, EntryError};
use drillsweep_quantity::{Name, Quantity, units};
use drillsweep_scenario::nearest;
use serde::{Deserialize, Serialize};

/// Largest number of limits in a request.
const MOST_LIMITS: usize = 64;

/// Limits by column, in the column's unit; values that are larger in magnitude exceed them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(transparent)]
pub struct OperatingLimits(BTreeMap<String, f64>);

/// Changes of limits by column, in the column's unit; absent values remove a limit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LimitChanges(Vec<(String, Option<f64>)>);

/// Reason for which limits cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LimitError {
    /// An entry is no column with a value.
    #[error("\"{0}\" is no limit: give COLUMN:VALUE or COLUMN:off, separated by commas")]
    Form(String),
    /// The column is no number of a point.
    #[error("there is no column \"{name}\" with a limit{}", .similar.as_ref().map_or_else(String::new, |name| format!("; did you mean \"{name}\"?")))]
    NoColumn {
        /// Name as requested.
        name: String,
        /// The most similar name, if any is similar.
        similar: Option<String>,
    },
    /// A limit is no number above zero.
    #[error("the limit of {0} must be a number greater than 0, or off")]
    Value(String),
    /// A limit has a unit that is unknown, or of another dimension.
    #[error("the limit of {column} must be {error}")]
    Unit {
        /// The column.
        column: String,
        /// Units that fit.
        error: EntryError,
    },
    /// There are too many.
    #[error("at most {MOST_LIMITS} limits can be given")]
    TooMany,
}

/// Columns whose limits decide a class of their own.
static OF_CLASSES: [&Quantity; 5] = [
    &LARGEST_BUCKLING_RATIO,
    &BIT_STICK_SLIP_SEVERITY,
    &BACKWARD_WHIRL_FRACTION,
    &FORWARD_WHIRL_FRACTION,
    &LARGEST_SHOCK_RATE_10G,
];

/// The default limits, in the columns' units.
static DEFAULTS: [(&Quantity, f64); 9] = [
    // Sinusoidal buckling: Dawson and Paslay 1984, in curved holes He and Kyllingstad 1995.
    (&LARGEST_BUCKLING_RATIO, 1.0),
    // The bit just stops at its slowest.
    (&BIT_STICK_SLIP_SEVERITY, 1.0),
    // Chosen: more than a short assembly of a few hundred metres of string.
    (&BACKWARD_WHIRL_FRACTION, 0.05),
    (&FORWARD_WHIRL_FRACTION, 0.05),
    // Chosen: one shock a minute.
    (&LARGEST_SHOCK_RATE_10G, 1.0 / 60.0),
    // Field practice calls lateral vibration severe from 2 to 3 g rms on.
    (&LARGEST_LATERAL_ACCELERATION_RMS, 2.0 * units::ACCELERATION.shown.size),
    // Fatigue of grade S-135 without tension: 20 ksi (API RP 7G, after Lubinski).
    (&LARGEST_BENDING_STRESS, 20.0 * units::STRESS.field.size),
    // Definition: yield.
    (&LARGEST_YIELD_RATIO, 1.0),
    // Least yield strength of grade E: 75 ksi (API Spec 5DP).
    (&LARGEST_EQUIVALENT_STRESS, 75.0 * units::STRESS.field.size),
];

impl Default for OperatingLimits {
    fn default() -> Self {
        Self(DEFAULTS.iter().map(|(column, limit)| (column.name.to_owned(), *limit)).collect())
    }
}

impl OperatingLimits {
    /// Columns with their limits, for conversion.
    pub(crate) fn values_mut(&mut self) -> impl Iterator<Item = (&str, &mut f64)> {
        self.0.iter_mut().map(|(column, limit)| (column.as_str(), limit))
    }
}

impl LimitChanges {
    /// Changes from a text: `COLUMN:VALUE` or `COLUMN:off`, separated by commas. A value may have a unit: `largest_side_force:5 klbf`.
    ///
    /// # Errors
    /// An entry cannot be read, names no column of numbers, or is not above zero, or there are too many.
    pub fn parse(text: &str) -> Result<Self, LimitError> {
        let mut changes = Vec::new();
        let entries = text.split(',').map(str::trim).filter(|entry| !entry.is_empty());
        for (number, entry) in entries.enumerate() {
            if number >= MOST_LIMITS {
                return Err(LimitError::TooMany);
            }
            let (column, value) =
                entry.split_once(':').ok_or_else(|| LimitError::Form(shortened(entry).to_owned()))?;
            let (column, value) = (shortened(column.trim()), value.trim());
            let Some(name) = Name::parse(column) else {
                return Err(LimitError::NoColumn {
                    name: column.to_owned(),
                    similar: nearest(column, ALL.iter().map(|quantity| quantity.name)).map(str::to_owned),
                });
            };
            if value == "off" {
                changes.push((column.to_owned(), None));
                continue;
            }
            let limit = match (value.parse(), name.units()) {
                (Err(_), Some(units)) => match entry::read(value, units) {
                    Err(error @ EntryError::Unit(_)) => {
                        return Err(LimitError::Unit { column: column.to_owned(), error });
                    }
                    read => read.ok(),
                },
                (number, _) => number.ok(),
            };
            let limit = limit.filter(|limit: &f64| limit.is_finite() && *limit > 0.0);
            let limit = limit.ok_or_else(|| LimitError::Value(column.to_owned()))?;
            changes.push((column.to_owned(), Some(limit)));
        }
        Ok(Self(changes))
    }
}

impl OperatingLimits {
    /// The default limits with changes from a text.
    ///
    /// # Errors
    /// Errors of [`LimitChanges::parse`].
    pub fn parse(text: &str) -> Result<Self, LimitError> {
        Ok(Self::default().with(&LimitChanges::parse(text)?))
    }

    /// The same limits with changes, of which a later one replaces an earlier one of the same column.
    #[must_use]
    pub fn with(&self, changes: &LimitChanges) -> Self {
        let mut limits = self.clone();
        for (column, limit) in &changes.0 {
            match limit {
                Some(limit) => limits.0.insert(column.clone(), *limit),
                None => limits.0.remove(column),
            };
        }
        limits
    }

    /// Limits by column, in the column's unit.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.0.iter().map(|(column, limit)| (column.as_str(), *limit))
    }

    /// The same limits times a factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self(self.0.iter().map(|(column, limit)| (column.clone(), factor * limit)).collect())
    }

    /// Limit of a column; absent if it has none.
    pub(super) fn of(&self, quantity: &Quantity) -> Option<f64> {
        self.0.get(quantity.name).copied()
    }

    /// Limits of columns that decide no class of their own.
    pub(super) fn of_columns(&self) -> impl Iterator<Item = (&str, f64)> {
        let is_of_class = |column: &str| OF_CLASSES.iter().any(|quantity| quantity.name == column);
        self.0
            .iter()
            .map(|(column, limit)| (column.as_str(), *limit))
            .filter(move |(column, _)| !is_of_class(column))
    }
}

/// The beginning of a text, which no column's name exceeds.
fn shortened(text: &str) -> &str {
    const LONGEST: usize = 80;
    text.char_indices().nth(LONGEST).map_or(text, |(end, _)| &text[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_change_add_and_remove_defaults() {
        let limits = OperatingLimits::parse(
            "bit_stick_slip_severity:0.5, orbit_radius_rms_57_7m:2e-3,largest_bending_stress:off,",
        )
        .unwrap();
        assert_eq!(limits.of(&BIT_STICK_SLIP_SEVERITY), Some(0.5));
        assert_eq!(limits.of(&LARGEST_BENDING_STRESS), None);
        let others: Vec<_> = limits.of_columns().collect();
        assert!(others.contains(&("orbit_radius_rms_57_7m", 2e-3)), "{others:?}");
        assert!(others.iter().all(|(column, _)| *column != "bit_stick_slip_severity"));
        assert_eq!(OperatingLimits::parse("").unwrap(), OperatingLimits::default());
    }

    #[test]
    fn limits_have_units_of_their_columns() {
        let limits = OperatingLimits::parse(
            "largest_lateral_acceleration_rms:3 g,largest_side_force: 5 klbf,largest_bending_stress:20 ksi,largest_shock_rate_10g:2 1/min",
        )
        .unwrap();
        assert_eq!(limits.of(&LARGEST_LATERAL_ACCELERATION_RMS), Some(29.419_95));
        assert_eq!(limits.of(&LARGEST_SIDE_FORCE), Some(22_241.108_076_302_5));
        let wrong =
            OperatingLimits::parse("largest_lateral_acceleration_rms:3 klbf").unwrap_err().to_string();
        assert_eq!(
            wrong,
            "the limit of largest_lateral_acceleration_rms must be a number with one of the units m/s2, g, ft/s2; \
             `klbf` is a unit of force"
        );
    }

    #[test]
    fn limits_that_cannot_be_read_are_refused_with_the_reason() {
        let message = |text: &str| OperatingLimits::parse(text).unwrap_err().to_string();
        assert_eq!(
            message("largest_side_force"),
            "\"largest_side_force\" is no limit: give COLUMN:VALUE or COLUMN:off, separated by commas"
        );
        assert_eq!(
            message("larges_side_force:1"),
            "there is no column \"larges_side_force\" with a limit; did you mean \"largest_side_force\"?"
        );
        for value in ["0", "-1", "nan", "inf", "much"] {
            let text = format!("largest_side_force:{value}");
            assert_eq!(
                message(&text),
                "the limit of largest_side_force must be a number greater than 0, or off"
            );
        }
        let many = "largest_side_force:1,".repeat(MOST_LIMITS + 1);
        assert_eq!(message(&many), "at most 64 limits can be given");
    }
}
