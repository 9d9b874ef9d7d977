//! Rows of a report in words, and the finer rows of their method.

use super::results::{CostReport, CostRow};

/// The row itself and, if its steps are fixed, all finer rows of its method: a row that is right by chance has finer ones that are not.
pub(super) fn one_that_holds<'a>(
    report: &'a CostReport,
    row: &'a CostRow,
) -> impl Iterator<Item = &'a CostRow> {
    let is_finer = |other: &&CostRow| {
        row.tolerance.is_none()
            && other.integrator == row.integrator
            && other.contact_sweeps == row.contact_sweeps
            && other.tolerance.is_none()
            && other.step <= row.step
    };
    std::iter::once(row).chain(report.compared().filter(is_finer))
}

/// A row in words: its name if it has one of its own, its method, step and tolerance.
pub(super) fn stepping_words(row: &CostRow) -> String {
    let method = row.integrator.name();
    let mesh = if row.mesh_factor == 1.0 {
        String::new()
    } else {
        format!("element lengths x {}, ", rounded(row.mesh_factor))
    };
    let name = if row.name == method { mesh } else { format!("{}, {mesh}", row.name) };
    let step = format!("{} ms", rounded(1e3 * row.step));
    match row.tolerance {
        Some(tolerance) => format!("{name}{method} with a tolerance of {tolerance:e} and steps up to {step}"),
        None => format!("{name}{method} with a step of {step}"),
    }
}

/// A number without the noise of its last digits.
pub(super) fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}
