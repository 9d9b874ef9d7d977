//! A cost study as a text for terminals.

use std::fmt::Write as _;

use drillsweep_sim::study::{CostErrors, CostReport, CostRow};

use super::{step_text, three_digits};

/// What stands in a cell without a value.
const ABSENT: &str = "-";

/// The study in words and aligned columns.
pub fn text(report: &CostReport) -> String {
    let name = if report.scenario.is_empty() { "the scenario" } else { &report.scenario };
    let subject = if report.effects.is_empty() { "what accuracy costs" } else { "what each effect does" };
    let mut text = format!(
        "{subject}: runs of {name} over {} s, orbits and lines over [{}, {}) s\n",
        report.duration, report.window.from, report.window.to
    );
    let reference = &report.reference;
    let _ = writeln!(
        text,
        "reference: {} with {}, {} steps, {} elements, {} CPU s ({} per simulated s)",
        reference.integrator.name(),
        step_text(reference.step),
        reference.steps,
        reference.elements,
        three_digits(reference.cpu_time),
        three_digits(reference.cpu_per_simulated_second)
    );
    text.push_str(&match report.histories_part_at {
        Some(time) => format!(
            "a disturbance of 1e-6 m has parted the reference from itself after {} s: histories are compared up to \
             there, and beyond it only sizes and lines mean anything\n",
            three_digits(time)
        ),
        None => "a disturbance of 1e-6 m leaves the reference together with itself to the end: histories are compared \
                 over the whole run\n"
            .to_owned(),
    });
    if !report.methods.is_empty() {
        text.push_str("\nmethods, errors against the reference (relative, but lines in Hz)\n");
        text.push_str(&aligned(&method_columns(&report.methods), &report.methods));
    }
    if !report.meshes.is_empty() {
        text.push_str("\nmeshes, errors against the finest (relative, but lines in Hz)\n");
        text.push_str(&aligned(&mesh_columns(&report.meshes), &report.meshes));
    }
    if !report.effects.is_empty() {
        text.push_str(
            "\neffects, what changes without each (relative, but lines in Hz) and the time it saves\n",
        );
        text.push_str(&aligned(&effect_columns(report), &report.effects));
    }
    if !report.recommendations.is_empty() {
        text.push_str("\nrecommended\n");
        for recommendation in &report.recommendations {
            let _ = writeln!(text, "  {}", recommendation.text);
        }
    }
    if !report.warnings.is_empty() {
        text.push('\n');
        for warning in &report.warnings {
            let _ = writeln!(text, "warning: {warning}");
        }
    }
    text
}

/// A column of a table: its head, and its cell in every row.
struct Column {
    head: &'static str,
    cells: Vec<Option<String>>,
}

fn column(head: &'static str, rows: &[CostRow], cell: impl Fn(&CostRow) -> Option<String>) -> Column {
    Column { head, cells: rows.iter().map(cell).collect() }
}

fn errors(head: &'static str, rows: &[CostRow], error: fn(&CostErrors) -> Option<f64>) -> Column {
    column(head, rows, |row| row.errors.as_ref().and_then(error).map(error_text))
}

fn method_columns(rows: &[CostRow]) -> Vec<Column> {
    let mut columns = run_columns(rows);
    columns.extend([
        errors("history", rows, |errors| errors.trajectory),
        errors("orbit size", rows, |errors| Some(errors.orbit_size)),
        errors("mean radius", rows, |errors| Some(errors.mean_radius)),
        errors("line Hz", rows, |errors| errors.line_frequency_hz),
        errors("energy", rows, |errors| errors.energy),
        errors("own estimate", rows, |errors| Some(errors.estimate)),
    ]);
    columns
}

fn mesh_columns(rows: &[CostRow]) -> Vec<Column> {
    let mut columns = run_columns(rows);
    columns.splice(
        1..1,
        [
            column("lengths", rows, |row| Some(format!("x {}", three_digits(row.mesh_factor)))),
            column("elements", rows, |row| Some(row.elements.to_string())),
        ],
    );
    columns.extend([
        errors("statics", rows, |errors| Some(errors.static_position)),
        errors("C_f", rows, |errors| errors.friction_coefficient),
        errors("history", rows, |errors| errors.trajectory),
        errors("orbit size", rows, |errors| Some(errors.orbit_size)),
        errors("mean radius", rows, |errors| Some(errors.mean_radius)),
        errors("line Hz", rows, |errors| errors.line_frequency_hz),
    ]);
    columns
}

fn effect_columns(report: &CostReport) -> Vec<Column> {
    let rows = &report.effects;
    let whole = report.reference.cpu_per_simulated_second;
    let saved = |row: &CostRow| {
        let share = 100.0 * (1.0 - row.cpu_per_simulated_second / whole);
        (row.failure.is_none() && share.is_finite()).then(|| format!("{share:.0} %"))
    };
    vec![
        column("without", rows, |row| row.effect.map(|effect| effect.name().to_owned())),
        errors("statics", rows, |errors| Some(errors.static_position)),
        errors("C_f", rows, |errors| errors.friction_coefficient),
        errors("history", rows, |errors| errors.trajectory),
        errors("orbit size", rows, |errors| Some(errors.orbit_size)),
        errors("mean radius", rows, |errors| Some(errors.mean_radius)),
        errors("line Hz", rows, |errors| errors.line_frequency_hz),
        column("time saved", rows, saved),
    ]
}

fn run_columns(rows: &[CostRow]) -> Vec<Column> {
    let cut = rows.iter().any(|row| row.step_subdivisions > 1);
    vec![
        column("method", rows, |row| Some(row.integrator.name().to_owned())),
        column("step", rows, |row| Some(step_text(row.step))),
        column("cut in", rows, |row| cut.then(|| row.step_subdivisions.to_string())),
        column("CPU s per s", rows, |row| {
            row.failure.is_none().then(|| three_digits(row.cpu_per_simulated_second))
        }),
    ]
}

/// Errors that are rounding and nothing else.
const ROUNDING: f64 = 1e-14;

fn error_text(error: f64) -> String {
    if error < ROUNDING { "0".to_owned() } else { format!("{error:.1e}") }
}

/// The columns that have any value, the first flush left, the others flush right; then why runs failed.
fn aligned(columns: &[Column], rows: &[CostRow]) -> String {
    let columns: Vec<&Column> =
        columns.iter().filter(|column| column.cells.iter().any(Option::is_some)).collect();
    let shown = |column: &Column, row: usize| -> String {
        column.cells[row].clone().unwrap_or_else(|| ABSENT.to_owned())
    };
    let width = |column: &Column| {
        let cells = (0..rows.len()).map(|row| shown(column, row).chars().count());
        cells.chain([column.head.len()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = columns.iter().map(|column| width(column)).collect();
    let mut text = String::new();
    let mut line = |cell: &dyn Fn(&Column) -> String, end: &str| {
        for (number, (column, width)) in columns.iter().zip(&widths).enumerate() {
            let cell = cell(column);
            let _ = match number {
                0 => write!(text, "  {cell:<width$}"),
                _ => write!(text, "  {cell:>width$}"),
            };
        }
        text.push_str(end);
        text.push('\n');
    };
    line(&|column| column.head.to_owned(), "");
    for (number, row) in rows.iter().enumerate() {
        let failure = row.failure.as_ref().map(|reason| format!("  failed: {reason}")).unwrap_or_default();
        line(&|column| shown(column, number), &failure);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::tests::report;

    #[test]
    fn columns_are_aligned_and_what_no_run_has_is_left_out() {
        let text = text(&report());
        let lines: Vec<&str> = text.lines().collect();
        let at = lines.iter().position(|line| line.starts_with("methods")).unwrap();
        assert_eq!(
            lines[at + 1..at + 6],
            [
                "  method      step  CPU s per s  history  orbit size  mean radius  line Hz  own estimate",
                "  esdirk4   0.5 ms          0.8   7.5e-4      2.5e-4       2.5e-5        0        1.3e-3",
                "  esdirk4     1 ms          0.4   1.2e-2      4.0e-3       4.0e-4        0        2.0e-2",
                "  rk4      62.5 µs            -        -           -            -        -             -  \
                 failed: diverged at 0.1 s, at once",
                "  rk4        50 µs          4.2   3.0e-3      1.0e-3       1.0e-4        0        5.0e-3",
            ],
            "{text}"
        );
        assert!(text.contains("  x 0.5       585"), "{text}");
        let end = "recommended\n  1 %: esdirk4 with 1 ms, 24 s for 60 s\n\nwarning: a finer mesh meets a stiffer wall\n";
        assert!(text.ends_with(end), "{text}");
    }

    #[test]
    fn the_time_of_parting_is_told_in_words() {
        let mut report = report();
        assert!(text(&report).contains("after 1.23 s: histories are compared up to there"));
        report.histories_part_at = None;
        assert!(text(&report).contains("over the whole run"));
    }
}
