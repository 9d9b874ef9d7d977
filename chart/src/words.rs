//! Names of columns in words.

use drillsweep_quantity::Name;

/// A column's name in words; of a part of a list with which part it is.
pub(crate) fn words(name: &str) -> String {
    let label = Name::parse(name).map_or_else(|| name.replace('_', " "), |name| name.to_string());
    match name.rfind(']') {
        Some(end) => format!("{label} of {}", &name[..=end]),
        None => label,
    }
}
