//! Forced response over the speed of rotation, with critical speeds.

use std::fmt::Write as _;

use clap::Args;
use drillsweep_api::expand::UNINTERRUPTED;
use drillsweep_api::forced::{Excitation, ForcedRequest, table};
use drillsweep_quantity::{UnitSystem, units};
use drillsweep_sim::solve::modes::ComponentResponse;
use drillsweep_sim::validation::validate;
use drillsweep_table::csv;

use crate::print;
use crate::scenario::ScenarioArguments;
use crate::statics::{List, list};
use crate::text::{Alignment, columns};

#[derive(Args)]
pub(crate) struct ResponseArguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Speeds of rotation in rpm: a list or a range from:to:count; by default 40 to 240 in steps of 1.
    #[arg(long, value_name = "SPEEDS", value_parser = |text: &str| list("operation.rotation_speed_rpm", text))]
    speeds: Option<List>,
    /// Measured depth in m of a lateral force that turns with the string; by default the unbalance of the scenario excites it.
    #[arg(long, value_name = "METRES")]
    depth: Option<f64>,
    /// Amplitude of the force in N.
    #[arg(long, value_name = "NEWTON", default_value_t = 1000.0, requires = "depth")]
    force: f64,
    /// Cycles of the force in a revolution, such as the number of blades.
    #[arg(long, value_name = "CYCLES", default_value_t = 1.0, requires = "depth")]
    per_revolution: f64,
    /// Units of the table.
    #[arg(long, value_parser = ["si", "field"], default_value = "si", conflicts_with_all = ["json", "csv"])]
    units: String,
    /// Print all speeds as JSON.
    #[arg(long)]
    json: bool,
    /// Print all speeds as CSV.
    #[arg(long, conflicts_with = "json")]
    csv: bool,
}

/// Computes the response and prints it.
pub(crate) fn show(arguments: &ResponseArguments) -> anyhow::Result<()> {
    let scenario = arguments.scenario.resolve(None)?;
    validate(&scenario)?;
    let excitation = match arguments.depth {
        None => Excitation::Unbalance,
        Some(measured_depth) => Excitation::Turning {
            measured_depth,
            amplitude: arguments.force,
            per_revolution: arguments.per_revolution,
        },
    };
    let speeds = arguments.speeds.as_ref().map_or(Vec::new(), |speeds| speeds.0.clone());
    let rows = ForcedRequest { speeds, excitation }.rows(&scenario, UNINTERRUPTED)?;
    match (arguments.json, arguments.csv) {
        (true, _) => print(&serde_json::to_string_pretty(&rows)?),
        (_, true) => print(csv::write(&table(&rows))?.trim_end()),
        _ => {
            let system = if arguments.units == "field" { UnitSystem::Field } else { UnitSystem::Si };
            print(text(&scenario.name, &rows, system)?.trim_end());
        }
    }
    Ok(())
}

/// Critical speeds of the components from the top; if there are none, the largest response of each.
fn text(name: &str, rows: &[ComponentResponse], system: UnitSystem) -> Result<String, std::fmt::Error> {
    let name = if name.is_empty() { "the scenario" } else { name };
    let mut text = format!("forced response of {name} about its equilibrium, contacts closed\n");
    let [width, depth, acceleration, force, stress] =
        [&units::WIDTH, &units::DEPTH, &units::ACCELERATION, &units::FORCE, &units::STRESS]
            .map(|units| units.of(system));
    let critical: Vec<&ComponentResponse> = rows.iter().filter(|row| row.is_critical).collect();
    let shown = if critical.is_empty() {
        writeln!(text, "no critical speed among these; largest responses:")?;
        let largest = |own: &[ComponentResponse]| {
            own.iter().max_by(|a, b| a.displacement[0].total_cmp(&b.displacement[0])).cloned()
        };
        rows.chunk_by(|a, b| a.component == b.component).filter_map(largest).collect()
    } else {
        writeln!(text, "critical speeds:")?;
        critical.into_iter().cloned().collect::<Vec<_>>()
    };
    let header = [
        "component".to_owned(),
        "rpm".to_owned(),
        format!("displacement {}", width.symbol),
        format!("at {}", depth.symbol),
        format!("acceleration {}", acceleration.symbol),
        format!("side force {}", force.symbol),
        format!("bending stress {}", stress.symbol),
    ];
    let line = |row: &ComponentResponse| {
        vec![
            row.component.clone(),
            format!("{:.1}", row.rotation_speed_rpm),
            format!("{:.4}", width.of(row.displacement[0])),
            format!("{:.1}", depth.of(row.displacement[1])),
            format!("{:.4}", acceleration.of(row.acceleration)),
            format!("{:.3}", force.of(row.side_force[0])),
            format!("{:.3}", stress.of(row.bending_stress[0])),
        ]
    };
    let header = header.each_ref().map(String::as_str);
    let lines: Vec<Vec<String>> = shown.iter().map(line).collect();
    let align = |column: usize| if column == 0 { Alignment::Left } else { Alignment::Right };
    text.push_str(&columns(&header, &lines, align));
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(
        component: &str,
        rotation_speed_rpm: f64,
        millimetres: f64,
        is_critical: bool,
    ) -> ComponentResponse {
        ComponentResponse {
            component: component.to_owned(),
            rotation_speed_rpm,
            frequency_hz: rotation_speed_rpm / 60.0,
            is_critical,
            displacement: [1e-3 * millimetres, 3420.5],
            acceleration: 0.0980665,
            side_force: [1.5e3, 3421.0],
            bending_moment: 2e3,
            bending_stress: [1.25e7, 3422.0],
        }
    }

    #[test]
    fn critical_speeds_are_listed_by_component_and_without_any_the_largest_responses() {
        let rows =
            [row("MWD", 120.0, 0.5, false), row("MWD", 121.0, 0.75, true), row("bit", 121.0, 0.1, false)];
        let critical = text("well", &rows, UnitSystem::Si).unwrap();
        let none =
            text("", &[row("MWD", 120.0, 0.5, false), row("MWD", 121.0, 0.4, false)], UnitSystem::Field);
        insta::assert_snapshot!([critical, none.unwrap()].join("\n"));
    }
}
