//! Cost studies as texts for terminals: their table, with short headings.

use std::fmt::Write as _;

use drillsweep_scenario::{AccuracyPreset, Integrator};
use drillsweep_study::cost::{Agreement, CostReport, CostRow, NodeAgreement, Quantity};
use drillsweep_table::{Column, Table};

use super::digits::{digits, step_text, three_digits};
use super::table::{Run, of_runs, runs};

/// Text of a cell without a value.
const ABSENT: &str = "-";

/// Sections of the text, as bits: methods, other starts and meshes, effects, several scenarios.
const METHODS: u8 = 1;
const VARIANTS: u8 = 2;
const EFFECTS: u8 = 4;
const SCENARIOS: u8 = 8;
/// Mark of columns that only runs until they have settled have.
const SETTLED: u8 = 16;

const RUNS: u8 = METHODS | VARIANTS;
const ERRORS: u8 = RUNS | EFFECTS;

/// Text of a number.
type Format = fn(f64) -> String;

/// Columns of the text: name in the table, heading, format of numbers, and sections.
const COLUMNS: [(&str, &str, Format, u8); 31] = [
    ("scenario", "scenario", three_digits, SCENARIOS),
    ("without_effect", "without", three_digits, EFFECTS),
    ("name", "name", three_digits, RUNS | SCENARIOS),
    ("mesh_factor", "lengths", times, VARIANTS),
    ("integrator", "method", three_digits, RUNS | SCENARIOS),
    ("step", "step", step_text, RUNS | SCENARIOS),
    ("tolerance", "tolerance", tolerance, RUNS | SCENARIOS),
    ("contact_sweeps", "iterations", three_digits, RUNS),
    ("step_subdivisions", "cut in", parts, RUNS),
    ("elements", "elements", measured, RUNS),
    ("simulated_time", "until s", measured, RUNS | SETTLED),
    ("motion_regime", "motion", three_digits, RUNS | SETTLED),
    ("steps", "steps", measured, RUNS),
    ("cpu_time", "CPU s", measured, RUNS | SETTLED),
    ("cpu_per_simulated_second", "CPU s per s", measured, RUNS | SCENARIOS),
    ("speed_over_rk4", "x rk4", three_digits, METHODS | SCENARIOS),
    ("promise", "promise", three_digits, METHODS | SCENARIOS),
    ("static_position_error", "statics", error_text, VARIANTS | EFFECTS),
    ("friction_coefficient_error", "C_f", error_text, VARIANTS | EFFECTS),
    ("trajectory_error", "history", error_text, ERRORS),
    ("orbit_size_bias", "orbit size", signed_percent, ERRORS | SCENARIOS),
    ("radius_deviation_bias", "std of radius", signed_percent, ERRORS | SCENARIOS),
    ("mean_radius_bias", "mean radius", signed_percent, ERRORS),
    ("contact_force_bias", "contact force", signed_percent, ERRORS),
    ("torsional_speed_bias", "torsional speed", signed_percent, ERRORS),
    ("line_frequency_error_hz", "line Hz", error_text, ERRORS),
    ("line_amplitude_error", "line height", percent, ERRORS),
    ("missing_lines", "missing", three_digits, METHODS),
    ("spurious_lines", "spurious", three_digits, METHODS | SCENARIOS),
    ("energy_error", "energy", error_text, METHODS),
    ("estimated_error", "own estimate", error_text, METHODS),
];

/// The study in words and aligned columns.
pub fn text(report: &CostReport) -> String {
    let mut text = head(report);
    if !report.agreements.is_empty() {
        text.push_str("\nthe reference: agreement of A and B\n");
        text.push_str(&agreements(&report.agreements));
    }
    let of_methods: &[&str] = if report.effects.is_empty() { &["reference", "method"] } else { &[] };
    let meshes = match report.settles {
        true => "meshes at the scenario's accuracy, against the reference",
        false => "meshes at the accuracy reference, against the finest",
    };
    for (section, roles, title) in [
        (METHODS, of_methods, "methods against the reference, A and B against each other"),
        (VARIANTS, &["start"], "the other start, against the reference"),
        (VARIANTS, &["mesh"], meshes),
        (EFFECTS, &["effect"], "effects, changes without each, with saved time"),
    ] {
        let runs: Vec<Run<'_>> = runs(report).filter(|(_, role, _)| roles.contains(role)).collect();
        if runs.is_empty() {
            continue;
        }
        let mut cells = cells(&runs, section, report.settles);
        if section == EFFECTS {
            let whole = report.references.first().map_or(0.0, |row| row.cpu_per_simulated_second);
            let saved = |(.., row): &Run<'_>| {
                let share = 100.0 * (1.0 - row.cpu_per_simulated_second / whole);
                if row.failure.is_none() && share.is_finite() {
                    format!("{share:.0} %")
                } else {
                    String::new()
                }
            };
            cells.push(("time saved", runs.iter().map(saved).collect()));
        }
        let _ = writeln!(text, "\n{title} (statistics and line heights in %)");
        text.push_str(&aligned(&cells, &failures(&runs)));
        if section == METHODS {
            runs.iter().for_each(|(.., row)| text.push_str(&spurious_line(row)));
        }
    }
    if !report.recommendations.is_empty() {
        text.push_str("\nrecommended\n");
    }
    for recommendation in &report.recommendations {
        let _ = writeln!(text, "  {}", recommendation.text);
    }
    if !report.warnings.is_empty() {
        text.push('\n');
    }
    for warning in &report.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}

/// The methods of several studies in aligned columns, with the promises of the accuracy presets.
pub fn overview(reports: &[CostReport]) -> String {
    let compared = |report| runs(report).filter(|(_, role, _)| ["reference", "method"].contains(role));
    let runs: Vec<Run<'_>> = reports.iter().flat_map(compared).collect();
    let promises = AccuracyPreset::ALL.map(|preset| {
        let [size, deviation] = [preset.promise().orbit_size, preset.promise().radius_deviation].map(percent);
        format!("{} {size} and {deviation} %", preset.name())
    });
    format!(
        "all scenarios: error of each run at its worst node (in %), {ABSENT} without a reference\n{}promises (orbit size and std of radius): {}; \
         spurious are lines above a twentieth of the highest; x rk4 is relative to the scenario's run of rk4 with the longest step\n",
        aligned(&cells(&runs, SCENARIOS, false), &failures(&runs)),
        promises.join(", ")
    )
}

/// Heading: runs, windows, reference, and meaning of the errors.
fn head(report: &CostReport) -> String {
    let name = if report.scenario.is_empty() { "the scenario" } else { &report.scenario };
    let subject = if report.effects.is_empty() { "cost of accuracy" } else { "significance of each effect" };
    let (duration, orbit) = (report.duration, &report.orbit_window);
    let mut text = format!("{subject}: runs of {name}");
    let _ = match report.settles {
        true => write!(text, ", each until its statistics have settled, {duration} s at most"),
        false => write!(text, " over {duration} s, statistics over [{}, {}) s", orbit.from, orbit.to),
    };
    if let Some(window) = &report.spectrum_window {
        let _ = write!(text, ", lines over [{}, {}) s", window.from, window.to);
    }
    if report.members > 1 {
        let _ = write!(text, ", {} members each", report.members);
    }
    if duration != report.scenario_duration {
        let _ = write!(
            text,
            " (the scenario lasts {} s; orbits are of the last third, lines of the last sixth)",
            report.scenario_duration
        );
    }
    let stepping = |row: &CostRow| {
        let tolerance =
            row.tolerance.map_or_else(String::new, |value| format!(" and a tolerance of {value:e}"));
        let iterations = match row.integrator {
            Integrator::Rk4 => String::new(),
            _ => format!(", up to {} contact iterations", row.contact_sweeps),
        };
        format!("{} with {}{tolerance}{iterations}", row.integrator.name(), step_text(row.step))
    };
    let _ = match report.references.as_slice() {
        [a, b] => writeln!(
            text,
            "\nreference: agreement of two methods, A: {}; B: {}; {} elements",
            stepping(a),
            stepping(b),
            a.elements.max(b.elements)
        ),
        rows => rows.iter().try_for_each(|row| {
            writeln!(
                text,
                "\nagainst the full model: {}, {} elements, {} CPU s ({} per simulated s)",
                stepping(row),
                row.elements,
                three_digits(row.cpu_time),
                three_digits(row.cpu_per_simulated_second)
            )
        }),
    };
    text.push_str(&match report.histories_part_at {
        _ if report.settles => {
            "errors are whole errors, of steps, mesh and sampling together; `until` is the time at which a run had settled and ended, and CPU s is its whole processor time\n".to_owned()
        }
        Some(time) => format!(
            "histories part after {} s (by the method, or by a disturbance of 1e-6 m): they are compared until \
             then, and beyond it only statistics and lines are comparable\n",
            three_digits(time)
        ),
        None => "histories stay together to the end, and are compared over the whole run\n".to_owned(),
    });
    text.push_str(match report.members {
        1 => "one member each: the confidence of a bias is unknown\n",
        _ => {
            "biases with half the width of their 95 % confidence interval, in brackets the members' standard \
             deviation; ~ if the interval contains zero\n"
        }
    });
    text
}

/// A column of the text: its heading, and its cell in every row, empty without a value.
type Cells = (&'static str, Vec<String>);

/// The columns of a section.
fn cells(runs: &[Run<'_>], section: u8, settles: bool) -> Vec<Cells> {
    let table = of_runs(runs);
    let mut columns = Vec::new();
    for (name, heading, format, sections) in COLUMNS {
        if sections & section == 0 || (sections & SETTLED != 0 && !settles) {
            continue;
        }
        let text = |value: f64| if value.is_finite() { format(value) } else { String::new() };
        let mut cells: Vec<String> = match table.columns.get(name) {
            Some(Column::Text(texts)) => texts.iter().map(|text| text.clone().unwrap_or_default()).collect(),
            _ if name.ends_with("_bias") => biases(&table, name),
            _ => numbers(&table, name).into_iter().map(text).collect(),
        };
        if name == "contact_sweeps" {
            let explicit =
                cells.iter_mut().zip(runs).filter(|(_, (.., row))| row.integrator == Integrator::Rk4);
            explicit.for_each(|(cell, _)| cell.clear());
        }
        columns.push((heading, cells));
    }
    columns
}

/// Reasons of failed rows; empty for the others.
fn failures(runs: &[Run<'_>]) -> Vec<String> {
    let failure = |(.., row): &Run<'_>| row.failure.as_ref().map(|reason| format!("failed: {reason}"));
    runs.iter().map(|run| failure(run).unwrap_or_default()).collect()
}

fn numbers(table: &Table, name: &str) -> Vec<f64> {
    table.columns.get(name).and_then(Column::numbers).unwrap_or_default()
}

/// Biases in per cent, with interval and spread if there are several members: `+39.8 ± 1.2 (2)`.
fn biases(table: &Table, name: &str) -> Vec<String> {
    let of = |part: &str| numbers(table, &name.replace("_bias", part));
    let (widths, spreads) = (of("_half_width"), of("_spread"));
    let rows = numbers(table, name).into_iter().zip(widths.into_iter().zip(spreads));
    rows.map(|(bias, (half_width, spread))| match (bias.is_finite(), half_width.is_finite()) {
        (false, _) => String::new(),
        (true, false) => signed_percent(bias),
        (true, true) => {
            let mark = if bias.abs() > half_width { "" } else { "~" };
            format!("{} ± {} ({}){mark}", signed_percent(bias), percent(half_width), percent(spread))
        }
    })
    .collect()
}

/// Agreement by quantity, at its worst node.
fn agreements(agreements: &[Agreement]) -> String {
    let worst = |agreement: &Agreement| -> Option<NodeAgreement> {
        agreement.nodes.iter().max_by(|a, b| a.difference.total_cmp(&b.difference)).cloned()
    };
    let value = |agreement: &Agreement, which: usize| {
        let Some(value) = worst(agreement).map(|node| node.values[which]) else { return String::new() };
        match agreement.quantity {
            Quantity::ContactForce => format!("{} N", three_digits(value)),
            Quantity::TorsionalSpeed => format!("{} rad/s", three_digits(value)),
            // Methods that agree still differ in four digits.
            _ => format!("{} mm", digits(1e3 * value, 4)),
        }
    };
    let depth = |agreement: &Agreement| {
        let depth = worst(agreement).and_then(|node| node.measured_depth);
        depth.map_or_else(String::new, |depth| format!("{} m", three_digits(depth)))
    };
    let difference = |agreement: &Agreement| {
        let interval = agreement.half_width.map_or_else(String::new, |half| format!(" ± {}", percent(half)));
        format!("{}{interval} %", percent(agreement.difference))
    };
    let verdict = |agreement: &Agreement| {
        let without = agreement.nodes.iter().filter(|node| !node.has_reference);
        let depths: Vec<_> = without.filter_map(|node| node.measured_depth).map(three_digits).collect();
        match agreement.has_reference {
            false => "NO REFERENCE EXISTS".to_owned(),
            true if depths.is_empty() => String::new(),
            true => format!("NO REFERENCE AT {} m", depths.join(", ")),
        }
    };
    let cells = |cell: &dyn Fn(&Agreement) -> String| agreements.iter().map(cell).collect::<Vec<_>>();
    let columns = [
        ("quantity", cells(&|agreement| agreement.quantity.words().to_owned())),
        ("worst at", cells(&depth)),
        ("A", cells(&|agreement| value(agreement, 0))),
        ("B", cells(&|agreement| value(agreement, 1))),
        ("differ by", cells(&difference)),
        ("allowed", cells(&|agreement| format!("{} %", percent(agreement.bound)))),
    ];
    aligned(&columns, &cells(&verdict))
}

/// The highest spurious line of a row, in words; empty without any.
fn spurious_line(row: &CostRow) -> String {
    let lines = row.errors.as_ref().and_then(|errors| errors.lines.as_ref());
    let highest = lines.and_then(|lines| lines.spurious.iter().max_by(|a, b| a.height.total_cmp(&b.height)));
    highest.map_or_else(String::new, |line| {
        format!(
            "  spurious of {} with {}: up to {} % of the highest line, at {:.2} Hz, {} m\n",
            row.name,
            step_text(row.step),
            percent(line.height),
            line.frequency_hz,
            three_digits(line.measured_depth)
        )
    })
}

/// Errors that are rounding and nothing else.
const ROUNDING: f64 = 1e-14;

fn error_text(error: f64) -> String {
    if error < ROUNDING { "0".to_owned() } else { format!("{error:.1e}") }
}

/// The size of a ratio in per cent, without that sign: `39.8`, `0.12`, `1e-4`.
fn percent(ratio: f64) -> String {
    let percent = 100.0 * ratio.abs();
    match percent {
        percent if percent < 100.0 * ROUNDING => "0".to_owned(),
        percent if percent < 0.01 => format!("{percent:.0e}"),
        percent if percent < 1.0 => three_digits((100.0 * percent).round() / 100.0),
        percent => three_digits(percent),
    }
}

/// A ratio in per cent with its sign, unless that is nothing but rounding.
fn signed_percent(ratio: f64) -> String {
    let size = percent(ratio);
    let sign = match ratio {
        _ if size == "0" => "",
        ratio if ratio < 0.0 => "-",
        _ => "+",
    };
    format!("{sign}{size}")
}

/// A number that is zero only if the run failed; empty then.
fn measured(value: f64) -> String {
    if value == 0.0 { String::new() } else { three_digits(value) }
}

/// Parts of a step; empty for a whole one.
fn parts(value: f64) -> String {
    if value > 1.0 { three_digits(value) } else { String::new() }
}

fn tolerance(value: f64) -> String {
    format!("{value:e}")
}

fn times(value: f64) -> String {
    format!("x {}", three_digits(value))
}

/// The columns that have any value, the first flush left, the others flush right; then a note on each row.
fn aligned(columns: &[Cells], notes: &[String]) -> String {
    let mut lines = vec![String::new(); notes.len() + 1];
    let shown = columns.iter().filter(|(_, cells)| cells.iter().any(|cell| !cell.is_empty()));
    for (number, (heading, cells)) in shown.enumerate() {
        let cell = |cell: &String| if cell.is_empty() { ABSENT.to_owned() } else { cell.clone() };
        let cells: Vec<String> =
            std::iter::once((*heading).to_owned()).chain(cells.iter().map(cell)).collect();
        let width = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
        for (line, cell) in lines.iter_mut().zip(cells) {
            let _ = match number {
                0 => write!(line, "  {cell:<width$}"),
                _ => write!(line, "  {cell:>width$}"),
            };
        }
    }
    for (line, note) in lines.iter_mut().skip(1).zip(notes).filter(|(_, note)| !note.is_empty()) {
        let _ = write!(line, "  {note}");
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use drillsweep_sim::solve::run::MotionRegime;

    use super::*;
    use crate::cost::tests::{report, with_draft, with_members};

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

    #[test]
    fn scenarios_are_listed_in_order_with_verdicts_on_promises() {
        let other = CostReport { scenario: "other".to_owned(), ..with_draft(0.041, Some(0.2)) };
        insta::assert_snapshot!(overview(&[report(), other]));
    }
}
