//! Friction factors of hole sections from measured hook loads and torques.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use drillsweep_api::torque_drag::{DragMode, FrictionFit, FrictionRequest, MeasuredPoint};
use drillsweep_import::{AssumedUnits, MeasuredOptions, MeasuredRow, measured};
use drillsweep_sim::validation::validate;

use crate::import::{bytes_of, choice, comments, name_of};
use crate::print;
use crate::scenario::ScenarioArguments;
use crate::text::{Alignment, columns};

#[derive(Args)]
pub(crate) struct FrictionArguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// CSV or Excel file of measured points: bit depth with hook loads in columns `Pick up`, `Slack off`, `Rotating` and the torque off bottom, or a row a point with `Mode`.
    #[arg(long, value_name = "FILE")]
    measured: PathBuf,
    /// Sheet of a workbook; the first one if absent.
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// Units of columns that have none: m, kN and kN m, or ft, klbf and ft lbf.
    #[arg(long, value_parser = PossibleValuesParser::new(["si", "field"]).try_map(choice::<AssumedUnits>))]
    assumed_units: Option<AssumedUnits>,
    /// Weight of top drive and travelling block in N, part of the hook loads.
    #[arg(long, value_name = "NEWTON", default_value_t = 0.0)]
    travelling_weight: f64,
    /// Axial speed of points of the mode ream in m/s, negative upwards.
    #[arg(long, value_name = "SPEED", allow_negative_numbers = true)]
    axial_speed: Option<f64>,
    /// Standard deviation of a measured hook load in N.
    #[arg(long, value_name = "NEWTON", default_value_t = 1e4)]
    hook_load_deviation: f64,
    /// Standard deviation of a measured torque in N m.
    #[arg(long, value_name = "NEWTON_METRES", default_value_t = 1e3)]
    torque_deviation: f64,
    /// Print factors and residuals as JSON.
    #[arg(long)]
    json: bool,
}

/// Fits the factors and prints them.
pub(crate) fn show(arguments: &FrictionArguments) -> anyhow::Result<()> {
    let scenario = arguments.scenario.resolve(None)?;
    validate(&scenario)?;
    let options =
        MeasuredOptions { sheet: arguments.sheet.as_deref(), assumed_units: arguments.assumed_units };
    let read =
        measured(&bytes_of(&arguments.measured)?, options).with_context(|| name_of(&arguments.measured))?;
    let request = FrictionRequest {
        points: read.points.iter().map(point).collect::<anyhow::Result<_>>()?,
        travelling_weight: arguments.travelling_weight,
        axial_speed: arguments.axial_speed,
        hook_load_deviation: arguments.hook_load_deviation,
        torque_deviation: arguments.torque_deviation,
    };
    let fit = request.fit(&scenario)?;
    if arguments.json {
        print(&serde_json::to_string_pretty(&fit)?);
    } else {
        let understood = comments(&read.columns, &[], &read.problems)?;
        print((understood + &text(&scenario.name, &request.points, &fit)?).trim_end());
    }
    Ok(())
}

fn point(row: &MeasuredRow) -> anyhow::Result<MeasuredPoint> {
    let mode = DragMode::named(row.mode).with_context(|| format!("no motion {}", row.mode))?;
    Ok(MeasuredPoint { bit_depth: row.bit_depth, mode, hook_load: row.hook_load, torque: row.torque })
}

fn text(name: &str, points: &[MeasuredPoint], fit: &FrictionFit) -> Result<String, std::fmt::Error> {
    let name = if name.is_empty() { "the scenario" } else { name };
    let mut text = format!("friction factors of {name} from {} measured points\n", points.len());
    for fitted in &fit.friction {
        let error = fitted.standard_error.map_or_else(String::new, |error| format!(" +- {error:.4}"));
        writeln!(text, "from {:.1} m: {:.4}{error}", fitted.from, fitted.friction)?;
    }
    if let Some(deviation) = fit.reduced_deviation {
        writeln!(text, "residuals are {deviation:.2} of the standard deviations")?;
    }
    let number =
        |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{:.2}", value / 1e3));
    let line = |(point, residual): (&MeasuredPoint, &drillsweep_sim::solve::soft_string::PointResidual)| {
        vec![
            format!("{:.1}", point.bit_depth),
            point.mode.name().to_owned(),
            number(point.hook_load),
            number(residual.hook_load),
            number(point.torque),
            number(residual.torque),
        ]
    };
    let header = ["bit at m", "mode", "hook kN", "residual kN", "torque kN m", "residual kN m"];
    let lines: Vec<Vec<String>> = points.iter().zip(&fit.residuals).map(line).collect();
    let align = |column: usize| if column == 1 { Alignment::Left } else { Alignment::Right };
    text.push_str(&columns(&header, &lines, align));
    Ok(text)
}
