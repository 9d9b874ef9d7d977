//! Small motions about a scenario's equilibrium: frequencies, growth, direction.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use drillsweep_api::mode_shapes::ShapesRequest;
use drillsweep_chart::mode_shapes;
use drillsweep_quantity::UnitChoice;
use drillsweep_quantity::columns::{FREQUENCY, MEASURED_DEPTH};
use drillsweep_scenario::Scenario;
use drillsweep_sim::solve::model::Model;
use drillsweep_sim::solve::modes::{BIT_NOT_JUDGED, Completeness, ModeKind, ModeSearch, Modes, modes};
use drillsweep_sim::solve::statics::Equilibrium;
use drillsweep_sim::validation::validate;
use drillsweep_table::csv;
use serde_json::json;

use crate::print;
use crate::scenario::ScenarioArguments;
use crate::text::Shown;

#[derive(Args)]
pub(crate) struct ModesArguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Lowest frequency in Hz.
    #[arg(long, value_name = "HERTZ", default_value_t = 0.0)]
    from: f64,
    /// Highest frequency in Hz.
    #[arg(long, value_name = "HERTZ", default_value_t = 20.0)]
    to: f64,
    /// Show only modes of this main motion.
    #[arg(long, value_parser = ["forward", "backward", "lateral", "torsional", "axial"])]
    kind: Option<String>,
    /// Show only the modes that grow.
    #[arg(long)]
    growing: bool,
    /// Units of `measured_depth` and `frequency`: `si`, `field`, and `COLUMN:UNIT`, separated by commas.
    #[arg(long, value_parser = UnitChoice::parse, default_value = "si", hide_default_value = true, conflicts_with = "json")]
    units: UnitChoice,
    /// File for the shapes of the first 100 modes of the band and kind along the string: a table (.csv) or a picture of the first eight (.svg).
    #[arg(long, value_name = "FILE", value_parser = ShapesFile::parse)]
    shapes: Option<ShapesFile>,
    /// Print the modes as JSON, in SI units.
    #[arg(long)]
    json: bool,
}

/// File for shapes of modes.
#[derive(Debug, Clone)]
struct ShapesFile {
    path: PathBuf,
    is_picture: bool,
}

impl ShapesFile {
    fn parse(text: &str) -> Result<Self, String> {
        let path = PathBuf::from(text);
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("svg") => Ok(Self { path, is_picture: true }),
            Some("csv") => Ok(Self { path, is_picture: false }),
            _ => Err("must end in .csv or .svg".to_owned()),
        }
    }

    fn write(&self, request: &ShapesRequest, scenario: &Scenario, units: &UnitChoice) -> anyhow::Result<()> {
        let table = request.table(scenario)?;
        let text = if self.is_picture {
            mode_shapes(&table, &scenario.name, units)?.svg()
        } else {
            csv::write(&table)?
        };
        fs::write(&self.path, text).with_context(|| format!("cannot write {}", self.path.display()))
    }
}

/// Finds the modes and prints them.
pub(crate) fn show(arguments: &ModesArguments) -> anyhow::Result<()> {
    let scenario = arguments.scenario.resolve(None)?;
    validate(&scenario)?;
    let model = Model::new(&scenario)?;
    let equilibrium = Equilibrium::find(&model)?;
    let search = ModeSearch { from_hz: arguments.from, to_hz: arguments.to, ..ModeSearch::default() };
    let mut found = modes(&model, &equilibrium, &search)?;
    if arguments.growing {
        found.modes.retain(|mode| mode.growth_rate > 0.0);
    }
    let kind =
        arguments.kind.as_ref().map(|kind| serde_json::from_value::<ModeKind>(json!(kind))).transpose()?;
    found.modes.retain(|mode| kind.is_none_or(|kind| mode.kind == kind));
    if let Some(file) = &arguments.shapes {
        let band_hz = [arguments.from, arguments.to];
        let request = ShapesRequest { band_hz, component: None, kind, depths: None };
        file.write(&request, &scenario, &arguments.units)?;
    }
    if arguments.json {
        print(&serde_json::to_string_pretty(&found)?);
    } else {
        print(text(&scenario.name, &found, model.effects.bit_rock, &arguments.units)?.trim_end());
    }
    Ok(())
}

fn text(name: &str, found: &Modes, includes_bit: bool, units: &UnitChoice) -> anyhow::Result<String> {
    let mut text = String::new();
    let name = if name.is_empty() { "the scenario" } else { name };
    let [depth, extent] = [0.01, 0.1].map(|resolution| Shown::new(units, &MEASURED_DEPTH, resolution));
    let [frequency, limit] = [1e-4, 1e-3].map(|resolution| Shown::new(units, &FREQUENCY, resolution));
    let place = format!("most at {}", depth.symbol());
    let width = place.len();
    writeln!(text, "modes of {name} about its equilibrium, contacts closed and sliding")?;
    writeln!(
        text,
        "{:>10} {:>11} {:>10} {:>7} {:>7} {:>7} {:>7}  {place}  nine tenths of the energy",
        frequency.symbol(),
        "growth 1/s",
        "kind",
        "lateral",
        "torsion",
        "axial",
        "whirl"
    )?;
    for mode in &found.modes {
        writeln!(
            text,
            "{:>10} {:>+11.4} {:>10} {:>7.3} {:>7.3} {:>7.3} {:>+7.2}  {:>width$}  {} to {}",
            frequency.number(mode.frequency_hz),
            mode.growth_rate,
            mode.kind.name(),
            mode.lateral_share,
            mode.torsional_share,
            mode.axial_share,
            mode.whirl,
            depth.number(mode.measured_depth),
            extent.number(mode.extent[0]),
            extent.with_unit(mode.extent[1])
        )?;
    }
    let (to, rate) = (limit.with_unit(found.complete_to_hz), found.complete_to_rate);
    if found.completeness == Completeness::Counted {
        writeln!(
            text,
            "complete to {to} for growth and decay below {rate:.3} 1/s, by a count of the eigenvalues; overdamped motions are left \
             out"
        )?;
    } else {
        writeln!(
            text,
            "searched to {to} for growth and decay below {rate:.3} 1/s: {}; overdamped motions are left out",
            found.completeness
        )?;
    }
    if !includes_bit {
        writeln!(text, "{BIT_NOT_JUDGED}")?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use drillsweep_sim::solve::modes::Mode;

    use super::*;

    #[test]
    fn modes_are_listed_with_the_range_that_was_searched() {
        let mode = |kind: &str, frequency_hz: f64, growth_rate: f64| -> Mode {
            let mode = json!({
                "frequency_hz": frequency_hz, "growth_rate": growth_rate, "kind": kind, "lateral_share": 0.998,
                "torsional_share": 0.0015, "axial_share": 0.0005, "whirl": -0.75, "node": 12, "measured_depth": 57.8,
                "extent": [12.25, 143.5],
            });
            serde_json::from_value(mode).unwrap()
        };
        let mut found = Modes {
            modes: vec![mode("torsional", 0.24, -0.031), mode("backward", 1.23456, 0.5)],
            complete_to_hz: 2.0,
            complete_to_rate: 1.5,
            completeness: Completeness::Counted,
        };
        let [si, field] = ["si", "field"].map(|units| UnitChoice::parse(units).unwrap());
        let [counted, in_feet] = [&si, &field].map(|units| text("paper-200m", &found, false, units).unwrap());
        found.modes.clear();
        found.completeness = Completeness::Missing(2);
        insta::assert_snapshot!([counted, in_feet, text("", &found, false, &si).unwrap()].join("\n"));
    }
}
