//! Stability map of bit and drive over rotation speed and weight on bit.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use drillsweep_api::expand::UNINTERRUPTED;
use drillsweep_api::stability_map::{AxialTop, StabilityRequest, table};
use drillsweep_chart::stability_map;
use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::GROWING_MOTIONS;
use drillsweep_sim::solve::stability_map::{StabilityMap, StabilityPoint};
use drillsweep_table::csv;

use crate::print;
use crate::scenario::ScenarioArguments;
use crate::statics::{List, list};

#[derive(Args)]
pub(crate) struct StabilityArguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Speeds of rotation in rpm: a list or a range from:to:count; by default 60 to 200 in steps of 2.
    #[arg(long, value_name = "SPEEDS", value_parser = |text: &str| list("operation.rotation_speed_rpm", text))]
    speeds: Option<List>,
    /// Weights on bit, positive: a list or a range from:to:count, in N or with a unit; by default that of the scenario.
    #[arg(long, value_name = "WEIGHTS", value_parser = |text: &str| list("operation.weight_on_bit", text))]
    weights: Option<List>,
    /// Axial condition of the top: it descends at the rate of penetration, or hangs on a constant hook load.
    #[arg(long, value_parser = ["advance", "hook_load"], default_value = "advance")]
    axial_top: String,
    /// File for a picture of the growing motions (.svg).
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Print all points as JSON.
    #[arg(long)]
    json: bool,
    /// Print all points as CSV.
    #[arg(long, conflicts_with = "json")]
    csv: bool,
}

/// Computes the map and prints it.
pub(crate) fn show(arguments: &StabilityArguments) -> anyhow::Result<()> {
    let scenario = arguments.scenario.resolve(None)?;
    let values = |list: &Option<List>| list.as_ref().map_or(Vec::new(), |list| list.0.clone());
    let axial_top = if arguments.axial_top == "hook_load" { AxialTop::HookLoad } else { AxialTop::Advance };
    let request = StabilityRequest {
        speeds: values(&arguments.speeds),
        weights: values(&arguments.weights),
        axial_top,
    };
    let map = request.map(&scenario, UNINTERRUPTED)?;
    if let Some(path) = &arguments.picture {
        let units = UnitChoice::default();
        let drawing = stability_map(&table(&map.points), GROWING_MOTIONS.name, &scenario.name, &units)?;
        fs::write(path, drawing.svg()).with_context(|| format!("cannot write {}", path.display()))?;
    }
    match (arguments.json, arguments.csv) {
        (true, _) => print(&serde_json::to_string_pretty(&map)?),
        (_, true) => print(csv::write(&table(&map.points))?.trim_end()),
        _ => print(text(&scenario.name, &map)?.trim_end()),
    }
    Ok(())
}

/// Map of the number of growing motions, the point of fastest growth, and the limits of the count.
fn text(name: &str, map: &StabilityMap) -> Result<String, std::fmt::Error> {
    let name = if name.is_empty() { "the scenario" } else { name };
    let points = &map.points;
    let by_speed: Vec<&[StabilityPoint]> =
        points.chunk_by(|a, b| a.rotation_speed_rpm == b.rotation_speed_rpm).collect();
    let mut text = format!("stability map of {name}: number of growing motions, `.` for none\n");
    writeln!(text, "weight kN")?;
    let weights = by_speed.first().map_or(0, |column| column.len());
    for weight in (0..weights).rev() {
        let row: String = by_speed.iter().map(|column| mark(&column[weight])).collect();
        writeln!(text, "{:>9.1} {row}", 1e-3 * by_speed[0][weight].weight_on_bit)?;
    }
    if let (Some(first), Some(last)) = (points.first(), points.last()) {
        let [from, to] = [first, last].map(|point| point.rotation_speed_rpm);
        writeln!(text, "          {from:.1} to {to:.1} rpm, {} speeds", by_speed.len())?;
    }
    let fastest = points
        .iter()
        .filter_map(|point| Some((point, point.growth_rate?, point.frequency_hz?)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((point, growth, frequency)) = fastest {
        writeln!(
            text,
            "fastest growth: {growth:.3} 1/s at {frequency:.3} Hz, {:.1} rpm and {:.1} kN",
            point.rotation_speed_rpm,
            1e-3 * point.weight_on_bit
        )?;
    }
    let incomplete = points.iter().filter(|point| !point.complete).count();
    if incomplete > 0 {
        writeln!(
            text,
            "warning: {incomplete} of {} points are not complete: motions above {:.0} Hz are not excluded there, or one was counted and not found",
            points.len(),
            map.complete_to_hz
        )?;
    }
    let above = points.iter().filter(|point| point.frequency_hz > Some(map.mesh_to_hz)).count();
    if above > 0 {
        writeln!(
            text,
            "warning: at {above} points the motion is faster than {:.1} Hz, to which the mesh has ten elements to the wave: the map does not depend on the mesh, a run in time or its modes do",
            map.mesh_to_hz
        )?;
    }
    Ok(text)
}

/// Mark of a point: its number of growing motions.
fn mark(point: &StabilityPoint) -> char {
    match point.growing {
        None => '?',
        Some(0) => '.',
        Some(count @ 1..10) => char::from(b'0' + count as u8),
        Some(_) => '+',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_has_weights_upwards_and_its_warnings() {
        let point =
            |rpm: f64, weight: f64, growing: Option<usize>, growth_rate: Option<f64>| StabilityPoint {
                rotation_speed_rpm: rpm,
                weight_on_bit: weight,
                torque_on_bit: 5e3,
                rate_of_penetration: None,
                growing,
                growth_rate,
                frequency_hz: growth_rate.map(|_| 7.5),
                complete: growing.is_some(),
            };
        let points = vec![
            point(60.0, 5e4, Some(1), Some(0.5)),
            point(60.0, 1e5, Some(3), Some(1.25)),
            point(120.0, 5e4, Some(0), None),
            point(120.0, 1e5, None, None),
        ];
        let map = StabilityMap { points, complete_to_hz: 300.0, mesh_to_hz: 6.4 };
        insta::assert_snapshot!(text("well", &map).unwrap());
    }
}
