//! Torque and drag of a soft string, over bit depth.

use std::fmt::Write as _;

use anyhow::{Context as _, bail};
use clap::Args;
use drillsweep_api::expand::UNINTERRUPTED;
use drillsweep_api::torque_drag::{Broomstick, table};
use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::{
    BIT_DEPTH, FRICTION_FACTOR, HOOK_LOAD, MEASURED_DEPTH, OVERPULL_MARGIN, SURFACE_TORQUE,
};
use drillsweep_sim::solve::soft_string::{AtDepth, BroomstickRow, DragMode, DragSettings};
use drillsweep_sim::validation::validate;
use drillsweep_table::csv;

use crate::print;
use crate::scenario::ScenarioArguments;
use crate::submit::parse_axis;
use crate::text::{Alignment, Shown, columns};

/// Largest number of values of a list.
const MOST_VALUES: usize = 5_000;

/// Compression over the buckling load from which it is shown.
const SHOWN: f64 = 0.005;

#[derive(Args)]
pub(crate) struct StaticsArguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Motions of the string: pick_up, slack_off, rotate, drill, slide, ream.
    #[arg(long, value_delimiter = ',', value_name = "MODES", value_parser = mode, default_values = ["pick_up", "slack_off", "rotate"])]
    modes: Vec<DragMode>,
    /// Bit depths: a list or a range from:to:count, in m or with a unit; by default 40 to that of the scenario. For a bit above the end of the string pipe is missing at the top.
    #[arg(long, value_name = "DEPTHS", value_parser = |text: &str| list(BIT_DEPTH.name, text))]
    depths: Option<List>,
    /// Friction factors of the whole hole: a list or a range from:to:count; by default the dynamic friction of each hole section.
    #[arg(long, value_name = "FACTORS", value_parser = |text: &str| list(FRICTION_FACTOR.name, text))]
    friction: Option<List>,
    /// Weight of top drive and travelling block in N, part of the hook load.
    #[arg(long, value_name = "NEWTON", default_value_t = 0.0)]
    travelling_weight: f64,
    /// Axial speed of the mode ream in m/s, negative upwards.
    #[arg(long, value_name = "SPEED", allow_negative_numbers = true)]
    axial_speed: Option<f64>,
    /// Take the equilibria of the finite elements in place of the soft string, 60 cases at most; without --depths at the scenario's bit depth.
    #[arg(long)]
    stiff: bool,
    /// Units of depths, forces and torques: `si`, `field`, and `COLUMN:UNIT` for single columns, separated by commas; CSV then has units in its first line.
    #[arg(long, value_parser = UnitChoice::parse, conflicts_with = "json")]
    units: Option<UnitChoice>,
    /// Print the cases as JSON, in SI units.
    #[arg(long)]
    json: bool,
    /// Print the cases as CSV.
    #[arg(long, conflicts_with = "json")]
    csv: bool,
}

/// Values of an axis.
#[derive(Debug, Clone)]
pub(crate) struct List(pub(crate) Vec<f64>);

/// Reads a list or a range of values of a quantity, in SI units or with its own.
pub(crate) fn list(quantity: &str, text: &str) -> anyhow::Result<List> {
    let axis = parse_axis(quantity, text)?;
    let Some(count) = axis.count() else { bail!("write a list or a range from:to:count, got {text:?}") };
    if count > MOST_VALUES {
        bail!("{count} values are requested, of {MOST_VALUES} at most");
    }
    Ok(List((0..count).map(|i| axis.value(i)).collect()))
}

fn mode(name: &str) -> anyhow::Result<DragMode> {
    DragMode::named(name.trim())
        .with_context(|| format!("there are the modes {}", DragMode::ALL.map(DragMode::name).join(", ")))
}

/// Computes torque and drag and prints it.
pub(crate) fn show(arguments: &StaticsArguments) -> anyhow::Result<()> {
    let scenario = arguments.scenario.resolve(None)?;
    validate(&scenario)?;
    let values = |list: &Option<List>| list.as_ref().map_or(Vec::new(), |list| list.0.clone());
    let broomstick = Broomstick {
        modes: arguments.modes.clone(),
        depths: values(&arguments.depths),
        friction: values(&arguments.friction),
        settings: DragSettings {
            travelling_weight: arguments.travelling_weight,
            axial_speed: arguments.axial_speed,
        },
        is_stiff: arguments.stiff,
    };
    let rows = broomstick.rows(&scenario, UNINTERRUPTED)?;
    let units = arguments.units.clone().unwrap_or_default();
    match (arguments.json, arguments.csv) {
        (true, _) => print(&serde_json::to_string_pretty(&rows)?),
        (_, true) => print(csv_text(&rows, &units)?.trim_end()),
        _ => {
            let string = if arguments.stiff { "the finite elements" } else { "a soft string in still mud" };
            print(text(&scenario.name, string, &rows, &units)?.trim_end());
        }
    }
    Ok(())
}

/// Cases as CSV, with units in the first line if they were chosen.
fn csv_text(rows: &[BroomstickRow], units: &UnitChoice) -> anyhow::Result<String> {
    let table = table(rows);
    if units.is_kept() {
        return Ok(csv::write(&table)?);
    }
    let mut bytes = Vec::new();
    csv::write_with_units(&table.in_units(units), &mut bytes)?;
    Ok(String::from_utf8(bytes)?)
}

/// Units of the text's numbers; differences of 0.1 m, 100 N and 10 N m are kept.
struct TextUnits {
    bit_depth: Shown,
    depth: Shown,
    hook_load: Shown,
    torque: Shown,
    overpull: Shown,
}

impl TextUnits {
    fn new(choice: &UnitChoice) -> Self {
        Self {
            bit_depth: Shown::new(choice, &BIT_DEPTH, 0.1),
            depth: Shown::new(choice, &MEASURED_DEPTH, 0.1),
            hook_load: Shown::new(choice, &HOOK_LOAD, 100.0),
            torque: Shown::new(choice, &SURFACE_TORQUE, 10.0),
            overpull: Shown::new(choice, &OVERPULL_MARGIN, 100.0),
        }
    }
}

fn text(
    name: &str,
    string: &str,
    rows: &[BroomstickRow],
    units: &UnitChoice,
) -> Result<String, std::fmt::Error> {
    let name = if name.is_empty() { "the scenario" } else { name };
    let units = TextUnits::new(units);
    let mut text = format!("torque and drag of {name}, {string}\n");
    for rows in rows.chunk_by(|a, b| a.mode == b.mode) {
        writeln!(text, "\n{}\n{}", rows[0].mode.name(), mode_text(rows, &units))?;
        let worst = |value: &dyn Fn(&BroomstickRow) -> Option<AtDepth>, sign: f64| {
            let found = rows.iter().filter_map(|row| Some((value(row)?, row.bit_depth)));
            found.max_by(|(a, _), (b, _)| (sign * a.value).total_cmp(&(sign * b.value)))
        };
        let at = |(of, bit_depth): (AtDepth, f64)| {
            let [depth, bit_depth] =
                [units.depth.with_unit(of.measured_depth), units.bit_depth.with_unit(bit_depth)];
            format!("at {depth} with the bit at {bit_depth}")
        };
        if let Some(found) =
            worst(&|row| row.margins.buckling_ratio.filter(|ratio| ratio.value >= SHOWN), 1.0)
        {
            let kind = match found.0.value {
                ratio if ratio >= 2_f64.sqrt() => ", helical",
                ratio if ratio >= 1.0 => ", sinusoidal",
                _ => "",
            };
            writeln!(
                text,
                "largest compression: {:.2} of the buckling load{kind}, {}",
                found.0.value,
                at(found)
            )?;
        }
        if let Some(found) = worst(&|row| row.margins.yield_ratio, 1.0) {
            writeln!(text, "largest stress: {:.2} of the yield strength, {}", found.0.value, at(found))?;
        }
        if let Some(found) = worst(&|row| row.margins.make_up_ratio, 1.0) {
            writeln!(text, "largest torque: {:.2} of the make-up torque, {}", found.0.value, at(found))?;
        }
        if let Some(found) = worst(&|row| row.margins.overpull, -1.0) {
            writeln!(
                text,
                "least margin of overpull: {}, {}",
                units.overpull.with_unit(found.0.value),
                at(found)
            )?;
        }
    }
    Ok(text)
}

/// Hook loads, and torques if there are any, of one mode: a row a bit depth, columns by friction.
fn mode_text(rows: &[BroomstickRow], units: &TextUnits) -> String {
    let turns = rows.iter().any(|row| row.surface_torque != 0.0);
    let by_friction: Vec<&[BroomstickRow]> = rows.chunk_by(|a, b| a.friction == b.friction).collect();
    let with = |name: &str, shown: &Shown, row: &BroomstickRow| match row.friction {
        Some(friction) => format!("{name} {} at {friction}", shown.symbol()),
        None => format!("{name} {}", shown.symbol()),
    };
    let firsts = || by_friction.iter().map(|rows| &rows[0]);
    let mut header = vec![format!("bit at {}", units.bit_depth.symbol())];
    header.extend(firsts().map(|row| with("hook", &units.hook_load, row)));
    header.extend(firsts().filter(|_| turns).map(|row| with("torque", &units.torque, row)));
    let line = |i: usize| {
        let at_depth = || by_friction.iter().map(|rows| &rows[i]);
        let mut cells = vec![units.bit_depth.number(rows[i].bit_depth)];
        cells.extend(at_depth().map(|row| units.hook_load.number(row.hook_load)));
        cells.extend(at_depth().filter(|_| turns).map(|row| units.torque.number(row.surface_torque)));
        cells
    };
    let lines: Vec<Vec<String>> = (0..by_friction[0].len()).map(line).collect();
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    columns(&header, &lines, |_| Alignment::Right)
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{Grade, preset};

    use super::*;

    #[test]
    fn torque_and_drag_is_a_table_a_mode_with_its_margins() {
        let mut scenario = preset("paper-200m").unwrap();
        scenario.string.material.grade = Some(Grade::G105);
        let broomstick = Broomstick {
            modes: vec![DragMode::PickUp, DragMode::SlackOff, DragMode::Rotate, DragMode::Drill],
            depths: list(BIT_DEPTH.name, "100:200:3").unwrap().0,
            friction: list(FRICTION_FACTOR.name, "0.2,0.3").unwrap().0,
            settings: DragSettings { travelling_weight: 2e5, axial_speed: None },
            is_stiff: false,
        };
        let rows = broomstick.rows(&scenario, UNINTERRUPTED).unwrap();
        let text = |units: &str| {
            text("paper-200m", "a soft string in still mud", &rows, &UnitChoice::parse(units).unwrap())
                .unwrap()
        };
        insta::assert_snapshot!(text("si"));
        insta::assert_snapshot!("field_units", text("field,bit_depth:m"));
    }

    #[test]
    fn csv_has_chosen_units_in_its_first_line() {
        let settings = DragSettings::default();
        let broomstick = Broomstick {
            modes: vec![DragMode::Rotate],
            depths: vec![152.4],
            friction: Vec::new(),
            settings,
            is_stiff: false,
        };
        let rows = broomstick.rows(&preset("paper-200m").unwrap(), UNINTERRUPTED).unwrap();
        let line = |units: &str, line: usize| {
            let text = csv_text(&rows, &UnitChoice::parse(units).unwrap()).unwrap();
            text.lines().nth(line).unwrap().split(',').take(4).collect::<Vec<_>>().join(",")
        };
        assert_eq!(line("field", 0), "drag_mode,friction_factor,bit_depth [ft],hook_load [klbf]");
        assert!(line("field,hook_load:kN", 1).starts_with("rotate,,500.0,"));
        let kept = csv_text(&rows, &UnitChoice::default()).unwrap();
        assert!(kept.starts_with("drag_mode,friction_factor,bit_depth,hook_load,"), "{kept}");
    }

    #[test]
    fn modes_and_depths_are_read_by_name_and_unit() {
        assert_eq!(mode(" slack_off").unwrap(), DragMode::SlackOff);
        assert!(mode("up").unwrap_err().to_string().contains("pick_up, slack_off"));
        assert_eq!(list(BIT_DEPTH.name, "1000ft").unwrap().0, [304.8]);
        assert!(list(BIT_DEPTH.name, "1:2").unwrap_err().to_string().contains("from:to:count"));
    }
}
