//! Names of columns: put together and taken apart.

use std::collections::HashMap;
use std::fmt;
use std::sync::LazyLock;

use crate::all::all;
use crate::columns;
use crate::definition::Quantity;
use crate::units::{self, Units};

/// A column's name, or a scenario's path, taken apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Name<'n> {
    /// Its quantity.
    pub quantity: &'static Quantity,
    /// Distinction between several columns of this quantity: `orbit_size_2_percent` of `cost_cpu_time`.
    pub detail: Option<&'n str>,
    /// Derivation of the quantity.
    pub variant: Variant,
    /// The node that it belongs to.
    pub place: Option<Place<'n>>,
    /// Number of the scenario's spectrum window that it belongs to, from 1.
    pub window: Option<usize>,
}

/// The place of a node in a column's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place<'n> {
    /// Its number, 1 at the top: `49`.
    Node(usize),
    /// The measured depth \[m\] for which it is recorded, on whatever mesh: `57_7m`.
    Depth(&'n str),
    /// The distance above the bit \[m\] for which it is recorded: `12_5m_above_bit`.
    AboveBit(&'n str),
}

/// End of a place above the bit in names.
const ABOVE_BIT: &str = "_above_bit";

impl<'n> Place<'n> {
    /// The number of the node; absent for one that is recorded for its depth.
    pub fn node(self) -> Option<usize> {
        match self {
            Place::Node(node) => Some(node),
            Place::Depth(_) | Place::AboveBit(_) => None,
        }
    }

    /// The measured depth \[m\] for which the node is recorded; absent for one by number or above the bit.
    pub fn depth(self) -> Option<f64> {
        match self {
            Place::Depth(depth) => in_metres(depth),
            Place::Node(_) | Place::AboveBit(_) => None,
        }
    }

    /// The distance above the bit \[m\] for which the node is recorded; absent for others.
    pub fn height(self) -> Option<f64> {
        match self {
            Place::AboveBit(height) => in_metres(height.trim_end_matches(ABOVE_BIT)),
            Place::Node(_) | Place::Depth(_) => None,
        }
    }

    /// The place as names of columns have it: `49`, `57_7m`, `12_5m_above_bit`.
    pub fn in_names(self) -> String {
        match self {
            Place::Node(node) => node.to_string(),
            Place::Depth(text) | Place::AboveBit(text) => text.to_owned(),
        }
    }

    /// Depth \[m\] as names of columns have it: `57_7m` for 57.7 m.
    pub fn of_depth(depth: f64) -> String {
        // Rounding may have left the top at -0.
        format!("{}m", depth.abs()).replace('.', "_")
    }

    /// Distance above the bit \[m\] as names of columns have it: `12_5m_above_bit` for 12.5 m.
    pub fn of_height(height: f64) -> String {
        Self::of_depth(height) + ABOVE_BIT
    }

    /// A name without the place at its end, and the place.
    fn take(name: &'n str) -> (&'n str, Option<Self>) {
        if let Some(without) = name.strip_suffix(ABOVE_BIT) {
            return match Self::take(without) {
                (rest, Some(Place::Depth(_))) => (rest, Some(Place::AboveBit(&name[rest.len() + 1..]))),
                _ => (name, None),
            };
        }
        let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        let Some((rest, last)) = name.rsplit_once('_') else { return (name, None) };
        if is_number(last) {
            return last.parse().map_or((name, None), |node| (rest, Some(Place::Node(node))));
        }
        if !last.strip_suffix('m').is_some_and(is_number) {
            return (name, None);
        }
        match rest.rsplit_once('_').filter(|(_, whole)| is_number(whole)) {
            Some((rest, _)) => (rest, Some(Place::Depth(&name[rest.len() + 1..]))),
            None => (rest, Some(Place::Depth(last))),
        }
    }
}

/// Metres of a text such as `57_7m`.
fn in_metres(text: &str) -> Option<f64> {
    text.trim_end_matches('m').replace('_', ".").parse().ok()
}

/// `node 49`, `57.7 m`, `12.5 m above the bit`.
impl fmt::Display for Place<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Node(node) => write!(formatter, "node {node}"),
            Place::Depth(depth) => {
                write!(formatter, "{} m", depth.trim_end_matches('m').replace('_', "."))
            }
            Place::AboveBit(height) => {
                let height = height.trim_end_matches(ABOVE_BIT).trim_end_matches('m').replace('_', ".");
                write!(formatter, "{height} m above the bit")
            }
        }
    }
}

/// Derivation of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Variant {
    /// Nothing: the value itself.
    Value,
    /// The mean over the members of an ensemble.
    EnsembleMean,
    /// The standard deviation over the members of an ensemble.
    Spread,
    /// Half the width of the confidence interval of 95 %.
    Confidence,
    /// The value of the reference run.
    Reference,
    /// The value less that of the reference: relative, but for frequencies.
    Bias,
}

impl Variant {
    /// All, the value itself first.
    pub const ALL: [Variant; 6] = [
        Variant::Value,
        Variant::EnsembleMean,
        Variant::Spread,
        Variant::Confidence,
        Variant::Reference,
        Variant::Bias,
    ];

    /// Prefix of the quantity's name.
    pub fn prefix(self) -> &'static str {
        match self {
            Variant::Value => "",
            Variant::EnsembleMean => "ensemble_mean_",
            Variant::Spread => "spread_",
            Variant::Confidence => "confidence_",
            Variant::Reference => "reference_",
            Variant::Bias => "bias_",
        }
    }

    /// The name of the column that has this of the one called `name`.
    pub fn of(self, name: &str) -> String {
        format!("{}{name}", self.prefix())
    }

    /// The name that a column's own was made from, if it is of this variant.
    pub fn strip(self, name: &str) -> Option<&str> {
        name.strip_prefix(self.prefix())
    }
}

static BY_NAME: LazyLock<HashMap<&'static str, &'static Quantity>> =
    LazyLock::new(|| all().map(|quantity| (quantity.name, quantity)).collect());

impl<'n> Name<'n> {
    /// Takes a name apart; none if it is of no quantity of the vocabulary.
    pub fn parse(name: &'n str) -> Option<Self> {
        let alone =
            |quantity| Name { quantity, detail: None, variant: Variant::Value, place: None, window: None };
        if let Some(quantity) = BY_NAME.get(name) {
            return Some(alone(quantity));
        }
        if name.contains('.') {
            return BY_NAME.get(without_indices(name).as_str()).map(|quantity| alone(quantity));
        }
        if let Some((quantity, detail)) = of_family(name) {
            return Some(Name { detail: Some(detail), ..alone(quantity) });
        }
        let of_variant = |variant: Variant| Some((variant, variant.strip(name)?));
        let (variant, rest) =
            Variant::ALL.into_iter().skip(1).find_map(of_variant).unwrap_or((Variant::Value, name));
        let (rest, window) = without_number(rest, "_w");
        let (rest, place) = Place::take(rest);
        BY_NAME.get(rest).map(|quantity| Name { variant, place, window, ..alone(quantity) })
    }

    /// The units of the column. Biases are ratios, but for those of frequencies.
    pub fn units(&self) -> Option<&'static Units> {
        let own = self.quantity.units?;
        let is_ratio = self.variant == Variant::Bias && own != &units::FREQUENCY;
        Some(if is_ratio { &units::RATIO } else { own })
    }

    /// The unit in which the column is kept and served (`1` for ratios).
    pub fn unit(&self) -> Option<&'static str> {
        self.units().map(|units| units.kept)
    }
}

/// Name of the column in pictures.
impl fmt::Display for Name<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.variant != Variant::Value {
            write!(formatter, "{} of ", self.variant.prefix().trim_end_matches('_').replace('_', " "))?;
        }
        write!(formatter, "{}", self.quantity.label)?;
        if let Some(detail) = self.detail {
            write!(formatter, " {}", detail.replace('_', " "))?;
        }
        match self.place {
            Some(place @ Place::Node(_)) => write!(formatter, ", {place}")?,
            Some(place @ Place::Depth(_)) => write!(formatter, " at {place}")?,
            Some(place @ Place::AboveBit(_)) => write!(formatter, " {place}")?,
            None => {}
        }
        match self.window {
            Some(window) => write!(formatter, ", window {window}"),
            None => Ok(()),
        }
    }
}

/// The quantity of which a sweep's table has a column for each requested accuracy, with that accuracy.
fn of_family(name: &str) -> Option<(&'static Quantity, &str)> {
    let detail = name.strip_prefix(columns::COST_CPU_TIME.name)?.strip_prefix('_')?;
    Some((&columns::COST_CPU_TIME, detail))
}

/// A name without the number at its end, and the number.
fn without_number<'n>(name: &'n str, separator: &str) -> (&'n str, Option<usize>) {
    let parts = name.rsplit_once(separator).filter(|(_, number)| number.bytes().all(|b| b.is_ascii_digit()));
    match parts.and_then(|(rest, number)| Some((rest, number.parse().ok()?))) {
        Some((rest, number)) => (rest, Some(number)),
        None => (name, None),
    }
}

/// A scenario's path without the indices of its lists: `string.sections.count` of `string.sections[1].count`.
fn without_indices(path: &str) -> String {
    let mut inside = false;
    let is_kept = |character: &char| {
        let is_index = inside || *character == '[';
        inside = is_index && *character != ']';
        !is_index
    };
    path.chars().filter(is_kept).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Quantity, columns, unit};
    use super::*;

    #[test]
    fn names_are_taken_apart_as_they_are_put_together() {
        let quantities: [&Quantity; 3] =
            [&columns::LINE_AMPLITUDE, &columns::THETA_Z_RATE, &columns::ORBIT_RADIUS_RMS];
        for quantity in quantities {
            for variant in Variant::ALL {
                let shallow = Place::of_depth(0.05);
                let deep = Place::of_depth(3400.0);
                let high = Place::of_height(12.5);
                for (name, place, window) in [
                    (quantity.name.to_owned(), None, None),
                    (quantity.at_node(282), Some(Place::Node(282)), None),
                    (quantity.in_window("49", 2), Some(Place::Node(49)), Some(2)),
                    (quantity.at(&deep), Some(Place::Depth(&deep)), None),
                    (quantity.in_window(&shallow, 2), Some(Place::Depth(&shallow)), Some(2)),
                    (quantity.at(&high), Some(Place::AboveBit(&high)), None),
                    (quantity.in_window(&high, 1), Some(Place::AboveBit(&high)), Some(1)),
                ] {
                    let expected = Name { quantity, detail: None, variant, place, window };
                    assert_eq!(Name::parse(&variant.of(&name)), Some(expected), "{name}");
                }
            }
        }
    }

    #[test]
    fn units_do_not_depend_on_node_window_and_index() {
        assert_eq!(unit("u_49"), Some("m"));
        assert_eq!(unit("theta_z_rate_282"), Some("rad/s"));
        assert_eq!(unit("line_frequency_hz_49_w1"), Some("Hz"));
        assert_eq!(unit("spread_orbit_radius_rms_282"), Some("m"));
        assert_eq!(unit("ensemble_mean_line_frequency_hz_49_w2"), Some("Hz"));
        assert_eq!(unit("reference_orbit_mean_radius_49"), Some("m"));
        assert_eq!(unit("bias_orbit_mean_radius_49"), Some("1"));
        assert_eq!(unit("bias_line_frequency_hz_49_w1"), Some("Hz"));
        assert_eq!(unit("spread_orbit_radius_rms_57_7m"), Some("m"));
        assert_eq!(unit("cost_cpu_time_orbit_size_0_3_percent"), Some("s"));
        assert_eq!(unit("operation.rotation_speed_rpm"), Some("rpm"));
        assert_eq!(unit("string.sections[1].tool_joint.length"), Some("m"));
        assert_eq!(unit("string.sections[1].count"), None);
        for unknown in
            ["49", "_49", "u_", "u_49x", "u_99999999999999999999999", "u_m", "u_7_m", "mud", "regime"]
        {
            assert_eq!(unit(unknown), None, "{unknown}");
        }
    }

    #[test]
    fn depths_are_those_that_were_written() {
        assert_eq!(Place::of_depth(-0.0), "0m");
        for depth in [0.0, 11.7, 57.73, 980.0, 3412.25] {
            let text = Place::of_depth(depth);
            assert_eq!(Place::Depth(&text).depth(), Some(depth), "{text}");
        }
    }

    #[test]
    fn labels_say_which_column() {
        let label = |name| Name::parse(name).unwrap().to_string();
        assert_eq!(label("friction_coefficient"), "friction coefficient C_f");
        assert_eq!(label("spread_orbit_radius_rms_49"), "spread of lateral vibration, node 49");
        assert_eq!(label("line_amplitude_49_w1"), "amplitude of the highest line, node 49, window 1");
        assert_eq!(label("line_amplitude_57_73m_w1"), "amplitude of the highest line at 57.73 m, window 1");
        assert_eq!(label("orbit_radius_rms_980m"), "lateral vibration at 980 m");
        assert_eq!(label("string.sections[1].length"), "section length");
        assert_eq!(label("cost_cpu_time_orbit_size_2_percent"), "cost cpu time orbit size 2 percent");
    }
}
