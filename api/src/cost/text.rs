//! A cost study as a text for terminals.

use std::fmt::Write as _;

use drillsweep_scenario::Integrator;
use drillsweep_study::cost::{
    Agreement, CostErrors, CostReport, CostRow, LineErrors, NodeAgreement, Quantity, StatisticError,
};

use drillsweep_sim::solve::run::MotionRegime;

use super::digits::{step_text, three_digits};

/// Text of a cell without a value.
const ABSENT: &str = "-";

/// The study in words and aligned columns.
pub fn text(report: &CostReport) -> String {
    let mut text = head(report);
    if report.settles {
        text.push_str(
            "errors are whole errors, of steps, mesh and sampling together; `until` is the time at which a run had settled and ended, and CPU s is its whole processor time\n",
        );
    }
    text.push_str(&match report.histories_part_at {
        _ if report.settles => String::new(),
        Some(time) => format!(
            "histories part after {} s (by the method, or by a disturbance of 1e-6 m): they are compared until then, and \
             beyond it only statistics and lines mean anything\n",
            three_digits(time)
        ),
        None => "histories stay together to the end, and are compared over the whole run\n".to_owned(),
    });
    text.push_str(match report.members {
        1 => "one member each: the confidence of a bias is unknown\n",
        _ => {
            "biases with half the width of their 95 % confidence interval, in brackets the members' standard deviation; ~ if \
             the interval holds zero\n"
        }
    });
    if !report.agreements.is_empty() {
        text.push_str("\nthe reference: agreement of A and B\n");
        text.push_str(&agreement_lines(&report.agreements));
    }
    let rows: Vec<&CostRow> = report.compared().collect();
    if !rows.is_empty() {
        text.push_str("\nmethods against the reference, A and B against each other (statistics and line heights in %)\n");
        text.push_str(&aligned_rows(&method_columns(&rows), &rows));
        text.push_str(&spurious_lines(&rows));
    }
    let rows: Vec<&CostRow> = report.starts.iter().collect();
    if !rows.is_empty() {
        text.push_str("\nthe other start, against the reference (statistics and line heights in %)\n");
        text.push_str(&aligned_rows(&mesh_columns(&rows), &rows));
    }
    let rows: Vec<&CostRow> = report.meshes.iter().collect();
    if !rows.is_empty() {
        text.push_str(match report.settles {
            true => {
                "\nmeshes at the scenario's accuracy, against the reference (statistics and line heights in %)\n"
            }
            false => {
                "\nmeshes at the accuracy reference, against the finest (statistics and line heights in %)\n"
            }
        });
        text.push_str(&aligned_rows(&mesh_columns(&rows), &rows));
    }
    let rows: Vec<&CostRow> = report.effects.iter().collect();
    if !rows.is_empty() {
        text.push_str("\neffects, changes without each (statistics and line heights in %) and saved time\n");
        text.push_str(&aligned_rows(&effect_columns(report, &rows), &rows));
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

/// Heading: runs, windows and reference.
fn head(report: &CostReport) -> String {
    let name = if report.scenario.is_empty() { "the scenario" } else { &report.scenario };
    let subject = if report.effects.is_empty() { "cost of accuracy" } else { "significance of each effect" };
    let orbit = &report.orbit_window;
    let mut text = if report.settles {
        format!(
            "{subject}: runs of {name}, each until its statistics have settled, {} s at most",
            report.duration
        )
    } else {
        format!(
            "{subject}: runs of {name} over {} s, statistics over [{}, {}) s",
            report.duration, orbit.from, orbit.to
        )
    };
    if let Some(window) = &report.spectrum_window {
        let _ = write!(text, ", lines over [{}, {}) s", window.from, window.to);
    }
    if report.members > 1 {
        let _ = write!(text, ", {} members each", report.members);
    }
    if report.duration != report.scenario_duration {
        let _ = write!(
            text,
            " (the scenario lasts {} s; orbits are of the last third, lines of the last sixth)",
            report.scenario_duration
        );
    }
    text.push('\n');
    let stepping = |row: &CostRow| {
        let tolerance =
            row.tolerance.map_or_else(String::new, |tolerance| format!(" and a tolerance of {tolerance:e}"));
        let sweeps = match row.integrator {
            Integrator::Rk4 => String::new(),
            _ => format!(", up to {} contact iterations", row.contact_sweeps),
        };
        format!("{} with {}{tolerance}{sweeps}", row.integrator.name(), step_text(row.step))
    };
    let _ = match report.references.as_slice() {
        [a, b] => writeln!(
            text,
            "reference: agreement of two methods, A: {}; B: {}; {} elements",
            stepping(a),
            stepping(b),
            a.elements.max(b.elements)
        ),
        rows => rows.iter().try_for_each(|row| {
            writeln!(
                text,
                "against the full model: {}, {} elements, {} CPU s ({} per simulated s)",
                stepping(row),
                row.elements,
                three_digits(row.cpu_time),
                three_digits(row.cpu_per_simulated_second)
            )
        }),
    };
    text
}

/// A column of a table: its head, and its cell in every row.
pub(super) struct Cells {
    pub(super) head: &'static str,
    pub(super) cells: Vec<Option<String>>,
}

fn agreement_lines(agreements: &[Agreement]) -> String {
    let worst = |agreement: &Agreement| -> Option<NodeAgreement> {
        agreement.nodes.iter().max_by(|a, b| a.difference.total_cmp(&b.difference)).cloned()
    };
    let cells = |head, cell: &dyn Fn(&Agreement) -> Option<String>| Cells {
        head,
        cells: agreements.iter().map(cell).collect(),
    };
    let value = |agreement: &Agreement, which: usize| {
        let value = worst(agreement)?.values[which];
        Some(match agreement.quantity {
            Quantity::ContactForce => format!("{} N", three_digits(value)),
            Quantity::TorsionalSpeed => format!("{} rad/s", three_digits(value)),
            _ => format!("{} mm", four_digits(1e3 * value)),
        })
    };
    let columns = [
        cells("quantity", &|agreement| Some(agreement.quantity.words().to_owned())),
        cells("worst at", &|agreement| {
            worst(agreement)?.measured_depth.map(|depth| format!("{} m", three_digits(depth)))
        }),
        cells("A", &|agreement| value(agreement, 0)),
        cells("B", &|agreement| value(agreement, 1)),
        cells("differ by", &|agreement| {
            let interval =
                agreement.half_width.map_or_else(String::new, |half| format!(" ± {}", percent(half)));
            Some(format!("{}{interval} %", percent(agreement.difference)))
        }),
        cells("allowed", &|agreement| Some(format!("{} %", percent(agreement.bound)))),
    ];
    let verdict = |agreement: &Agreement| {
        if !agreement.has_reference {
            return "  NO REFERENCE EXISTS".to_owned();
        }
        let without = agreement.nodes.iter().filter(|node| !node.has_reference);
        let depths: Vec<_> = without.filter_map(|node| node.measured_depth).map(three_digits).collect();
        if depths.is_empty() { String::new() } else { format!("  NO REFERENCE AT {} m", depths.join(", ")) }
    };
    aligned(&columns, &agreements.iter().map(verdict).collect::<Vec<_>>())
}

fn column(head: &'static str, rows: &[&CostRow], cell: impl Fn(&CostRow) -> Option<String>) -> Cells {
    Cells { head, cells: rows.iter().map(|row| cell(row)).collect() }
}

fn errors(head: &'static str, rows: &[&CostRow], error: fn(&CostErrors) -> Option<f64>) -> Cells {
    column(head, rows, |row| row.errors.as_ref().and_then(error).map(error_text))
}

fn statistic(head: &'static str, rows: &[&CostRow], quantity: Quantity) -> Cells {
    column(head, rows, |row| row.errors.as_ref()?.statistic(quantity).map(statistic_text))
}

fn lines(head: &'static str, rows: &[&CostRow], cell: impl Fn(&LineErrors) -> Option<String>) -> Cells {
    column(head, rows, |row| cell(row.errors.as_ref()?.lines.as_ref()?))
}

fn line_columns(rows: &[&CostRow]) -> [Cells; 2] {
    [
        lines("line Hz", rows, |lines| lines.frequency_hz.map(error_text)),
        lines("line height", rows, |lines| Some(percent(lines.amplitude))),
    ]
}

/// Error of each line in every statistic.
fn statistic_columns(rows: &[&CostRow]) -> [Cells; 5] {
    [
        statistic("orbit size", rows, Quantity::OrbitSize),
        statistic("std of radius", rows, Quantity::RadiusDeviation),
        statistic("mean radius", rows, Quantity::MeanRadius),
        statistic("contact force", rows, Quantity::ContactForce),
        statistic("torsional speed", rows, Quantity::TorsionalSpeed),
    ]
}

fn method_columns(rows: &[&CostRow]) -> Vec<Cells> {
    let mut columns = run_columns(rows);
    columns.push(column("x rk4", rows, |row| row.speed_over_rk4.map(three_digits)));
    columns.extend(statistic_columns(rows));
    columns.extend(line_columns(rows));
    columns.extend([
        lines("missing", rows, |lines| Some(lines.missing.to_string())),
        lines("spurious", rows, |lines| Some(lines.spurious.len().to_string())),
        errors("history", rows, |errors| errors.trajectory),
        errors("energy", rows, |errors| errors.energy),
        errors("own estimate", rows, |errors| Some(errors.estimate)),
    ]);
    columns
}

fn mesh_columns(rows: &[&CostRow]) -> Vec<Cells> {
    let mut columns = run_columns(rows);
    columns.insert(1, column("lengths", rows, |row| Some(format!("x {}", three_digits(row.mesh_factor)))));
    columns.extend(change_columns(rows));
    columns
}

fn effect_columns(report: &CostReport, rows: &[&CostRow]) -> Vec<Cells> {
    let whole = report.references.first().map_or(0.0, |row| row.cpu_per_simulated_second);
    let saved = |row: &CostRow| {
        let share = 100.0 * (1.0 - row.cpu_per_simulated_second / whole);
        (row.failure.is_none() && share.is_finite()).then(|| format!("{share:.0} %"))
    };
    let mut columns = vec![column("without", rows, |row| row.effect.map(|effect| effect.name().to_owned()))];
    columns.extend(change_columns(rows));
    columns.push(column("time saved", rows, saved));
    columns
}

/// Changes that another mesh or another physics makes.
fn change_columns(rows: &[&CostRow]) -> Vec<Cells> {
    let mut columns = vec![
        errors("statics", rows, |errors| Some(errors.static_position)),
        errors("C_f", rows, |errors| errors.friction_coefficient),
        errors("history", rows, |errors| errors.trajectory),
    ];
    columns.extend(statistic_columns(rows));
    columns.extend(line_columns(rows));
    columns
}

fn run_columns(rows: &[&CostRow]) -> Vec<Cells> {
    let cut = rows.iter().any(|row| row.step_subdivisions > 1);
    let has_settled = |row: &CostRow| row.regime.filter(|regime| *regime != MotionRegime::Fixed);
    let settles = rows.iter().any(|row| has_settled(row).is_some());
    let until = |row: &CostRow| {
        has_settled(row).map(|regime| match regime {
            MotionRegime::NotSettled => "NOT SETTLED".to_owned(),
            _ => format!("{} s", three_digits(row.simulated_time)),
        })
    };
    let elements = rows.windows(2).any(|pair| pair[0].elements != pair[1].elements);
    let is_implicit = |row: &CostRow| row.integrator != Integrator::Rk4;
    let ran = |row: &CostRow, cell: String| row.failure.is_none().then_some(cell);
    vec![
        column("name", rows, |row| (row.name != row.integrator.name()).then(|| row.name.clone())),
        column("method", rows, |row| Some(row.integrator.name().to_owned())),
        column("step", rows, |row| Some(step_text(row.step))),
        column("tolerance", rows, |row| row.tolerance.map(|tolerance| format!("{tolerance:e}"))),
        column("iterations", rows, |row| is_implicit(row).then(|| row.contact_sweeps.to_string())),
        column("cut in", rows, |row| cut.then(|| row.step_subdivisions.to_string())),
        column("elements", rows, |row| elements.then(|| row.elements.to_string())),
        column("until", rows, until),
        column("steps", rows, |row| ran(row, row.steps.to_string())),
        column("CPU s", rows, |row| settles.then(|| three_digits(row.cpu_time))),
        column("CPU s per s", rows, |row| ran(row, three_digits(row.cpu_per_simulated_second))),
    ]
}

/// The spurious lines of each row, the highest named.
fn spurious_lines(rows: &[&CostRow]) -> String {
    let mut text = String::new();
    for row in rows {
        let lines = row.errors.as_ref().and_then(|errors| errors.lines.as_ref());
        let highest =
            lines.and_then(|lines| lines.spurious.iter().max_by(|a, b| a.height.total_cmp(&b.height)));
        if let Some(line) = highest {
            let _ = writeln!(
                text,
                "  spurious of {} with {}: up to {} % of the highest line, at {:.2} Hz, {} m",
                row.name,
                step_text(row.step),
                percent(line.height),
                line.frequency_hz,
                three_digits(line.measured_depth)
            );
        }
    }
    text
}

/// Errors that are rounding and nothing else.
const ROUNDING: f64 = 1e-14;

fn error_text(error: f64) -> String {
    if error < ROUNDING { "0".to_owned() } else { format!("{error:.1e}") }
}

/// The size of a ratio in per cent, without that sign: `39.8`, `0.12`, `1e-4`.
pub(super) fn percent(ratio: f64) -> String {
    let percent = 100.0 * ratio.abs();
    match percent {
        percent if percent < 100.0 * ROUNDING => "0".to_owned(),
        percent if percent < 0.01 => format!("{percent:.0e}"),
        percent if percent < 1.0 => three_digits((100.0 * percent).round() / 100.0),
        percent => three_digits(percent),
    }
}

/// A ratio in per cent with its sign, unless that is nothing but rounding.
pub(super) fn signed_percent(ratio: f64) -> String {
    let size = percent(ratio);
    let sign = match ratio {
        _ if size == "0" => "",
        ratio if ratio < 0.0 => "-",
        _ => "+",
    };
    format!("{sign}{size}")
}

/// A bias in per cent, with its interval and spread if there are several members: `+39.8 ± 1.2 (2)`.
fn statistic_text(error: &StatisticError) -> String {
    let mut text = signed_percent(error.bias);
    if let Some(half_width) = error.half_width {
        let _ = write!(text, " ± {}", percent(half_width));
    }
    if let Some(spread) = error.spread {
        let _ = write!(text, " ({})", percent(spread));
    }
    if error.significant == Some(false) {
        text.push('~');
    }
    text
}

/// A length to four digits, in which two methods that agree still differ.
pub(super) fn four_digits(value: f64) -> String {
    let whole_digits = value.abs().max(f64::MIN_POSITIVE).log10().floor() as i32 + 1;
    let decimals = usize::try_from(4 - whole_digits).unwrap_or(0).min(12);
    format!("{value:.decimals$}")
}

fn aligned_rows(columns: &[Cells], rows: &[&CostRow]) -> String {
    let failure =
        |row: &&CostRow| row.failure.as_ref().map(|reason| format!("  failed: {reason}")).unwrap_or_default();
    aligned(columns, &rows.iter().map(failure).collect::<Vec<_>>())
}

/// The columns that have any value, the first flush left, the others flush right; then the note on a row.
pub(super) fn aligned(columns: &[Cells], notes: &[String]) -> String {
    let columns: Vec<&Cells> =
        columns.iter().filter(|column| column.cells.iter().any(Option::is_some)).collect();
    let shown = |column: &Cells, row: usize| -> String {
        column.cells[row].clone().unwrap_or_else(|| ABSENT.to_owned())
    };
    let width = |column: &Cells| {
        let cells = (0..notes.len()).map(|row| shown(column, row).chars().count());
        cells.chain([column.head.len()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = columns.iter().map(|column| width(column)).collect();
    let mut text = String::new();
    let mut line = |cell: &dyn Fn(&Cells) -> String, end: &str| {
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
    for (number, note) in notes.iter().enumerate() {
        line(&|column| shown(column, number), note);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::tests::{report, with_members};

    #[test]
    fn a_study_is_a_table_of_methods_and_meshes_with_its_reference() {
        insta::assert_snapshot!(text(&report()));
    }

    #[test]
    fn members_show_bias_interval_and_spread_side_by_side() {
        let mut report = report();
        report.members = 5;
        report.histories_part_at = None;
        for row in &mut report.methods {
            with_members(row, 0.012, 0.02);
        }
        insta::assert_snapshot!(text(&report));
    }

    #[test]
    fn settled_runs_show_their_ends() {
        let mut report = CostReport { settles: true, ..report() };
        for (row, regime) in
            report.methods.iter_mut().zip([MotionRegime::Irregular, MotionRegime::NotSettled])
        {
            row.regime = Some(regime);
        }
        insta::assert_snapshot!(text(&report));
    }

    #[test]
    fn effects_show_changes_and_saved_time() {
        let mut report = report();
        report.references.truncate(1);
        report.effects = report.methods.split_off(1);
        report.effects[0].effect = Some(drillsweep_scenario::Effect::FluidDamping);
        (report.agreements, report.methods, report.meshes) = (Vec::new(), Vec::new(), Vec::new());
        insta::assert_snapshot!(text(&report));
    }
}
