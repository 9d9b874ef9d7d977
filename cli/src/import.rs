//! Parts of a scenario from files of other programs, as TOML to put into one.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::{Args, Subcommand};
use drillsweep_import::mud::{by_rp_13d, fit};
use drillsweep_import::{MOST_BYTES, MudFit, MudReport, Reading, Survey, SurveyOptions, survey};

use crate::print;

#[derive(Args)]
pub(crate) struct ImportArguments {
    #[command(subcommand)]
    part: Part,
}

#[derive(Subcommand)]
enum Part {
    /// Read a directional survey from CSV, Excel, LAS or a WITSML trajectory, and print `survey` of `[well]`.
    Survey(SurveyArguments),
    /// Fit a yield power law to viscometer readings, and print its fields of `[mud]`.
    Mud(MudArguments),
}

#[derive(Args)]
struct SurveyArguments {
    /// File with columns of measured depth, inclination and azimuth, with headings.
    file: PathBuf,
    /// Unit of measured depth if the file has none.
    #[arg(long, value_name = "UNIT")]
    depth_unit: Option<String>,
    /// Sheet of a workbook; the first one if absent.
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// Print stations, columns, remarks and problems as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct MudArguments {
    /// Readings of the viscometer, each with its speed in rev/min.
    #[arg(long, value_name = "RPM=DIAL", value_delimiter = ',', required_unless_present = "pv")]
    readings: Vec<String>,
    /// Plastic viscosity in cP, in place of readings.
    #[arg(long, value_name = "CP", conflicts_with = "readings", requires = "yp")]
    pv: Option<f64>,
    /// Yield point in lbf/100 ft2.
    #[arg(long, value_name = "POUNDS", requires = "pv")]
    yp: Option<f64>,
    /// Low-shear yield point in lbf/100 ft2.
    #[arg(long, value_name = "POUNDS", requires = "pv", default_value_t = 0.0)]
    lsyp: f64,
    /// Print all fits as JSON.
    #[arg(long)]
    json: bool,
}

/// Reads a file, or fits readings, and prints the part of a scenario.
pub(crate) fn show(arguments: &ImportArguments) -> anyhow::Result<()> {
    match &arguments.part {
        Part::Survey(arguments) => show_survey(arguments),
        Part::Mud(arguments) => show_mud(arguments),
    }
}

fn show_survey(arguments: &SurveyArguments) -> anyhow::Result<()> {
    let name = arguments.file.display();
    let failed = || format!("cannot read {name}");
    let size = std::fs::metadata(&arguments.file).with_context(failed)?.len();
    if size > MOST_BYTES as u64 {
        bail!("{name} has {size} bytes; {MOST_BYTES} is the limit");
    }
    let bytes = std::fs::read(&arguments.file).with_context(failed)?;
    let options =
        SurveyOptions { depth_unit: arguments.depth_unit.as_deref(), sheet: arguments.sheet.as_deref() };
    let read = survey(&bytes, options).with_context(|| name.to_string())?;
    if arguments.json {
        print(&serde_json::to_string_pretty(&read)?);
    } else {
        print(survey_text(&read)?.trim_end());
    }
    Ok(())
}

fn survey_text(read: &Survey) -> anyhow::Result<String> {
    let mut text = String::new();
    let deepest = read.stations.last().map_or(0.0, |station| station.measured_depth);
    writeln!(text, "# {} stations to {deepest:.2} m", read.stations.len())?;
    for column in &read.columns {
        let assumed = if column.is_assumed { ", not in the file" } else { "" };
        writeln!(
            text,
            "# {}: column {}, `{}`, in {}{assumed}",
            column.quantity, column.column, column.heading, column.unit
        )?;
    }
    for remark in &read.remarks {
        writeln!(text, "# {remark}")?;
    }
    for problem in &read.problems {
        let column = problem.column.as_ref().map_or_else(String::new, |column| format!(", column {column}"));
        writeln!(text, "# left out: row {}{column}, `{}`: {}", problem.row, problem.text, problem.problem)?;
    }
    writeln!(text, "survey = [")?;
    for station in &read.stations {
        writeln!(
            text,
            "    {{ measured_depth = {:?}, inclination_deg = {:?}, azimuth_deg = {:?} }},",
            station.measured_depth, station.inclination_deg, station.azimuth_deg
        )?;
    }
    writeln!(text, "]")?;
    Ok(text)
}

fn show_mud(arguments: &MudArguments) -> anyhow::Result<()> {
    if let (Some(pv), Some(yp)) = (arguments.pv, arguments.yp) {
        let Some(found) = by_rp_13d(pv, yp, arguments.lsyp) else {
            bail!("no yield power law has these values: PV and PV + YP - LSYP must be above 0");
        };
        let text = if arguments.json { serde_json::to_string_pretty(&found)? } else { fields(&found) };
        print(text.trim_end());
        return Ok(());
    }
    let readings: Vec<Reading> =
        arguments.readings.iter().map(|text| reading(text)).collect::<Result<_, _>>()?;
    let report = fit(&readings)?;
    let text = if arguments.json { serde_json::to_string_pretty(&report)? } else { mud_text(&report)? };
    print(text.trim_end());
    Ok(())
}

fn reading(text: &str) -> anyhow::Result<Reading> {
    let parts =
        text.split_once('=').and_then(|(rpm, dial)| rpm.trim().parse().ok().zip(dial.trim().parse().ok()));
    let Some((rpm, dial)) = parts else {
        bail!(
            "--readings must be speeds with their readings, such as 600=62,300=38,6=7,3=6: `{text}` is none"
        );
    };
    Ok(Reading { rpm, dial })
}

fn mud_text(report: &MudReport) -> anyhow::Result<String> {
    let mut text = String::new();
    let rows = [
        ("yield power law, least squares", Some(report.least_squares)),
        ("yield power law, API RP 13D", report.rp_13d),
        ("Bingham, least squares", report.bingham),
        ("power law, least squares", Some(report.power_law)),
    ];
    for (name, found) in rows.into_iter().filter_map(|(name, found)| Some((name, found?))) {
        writeln!(
            text,
            "# {name}: tau_y {:.4} Pa, K {:.5} Pa s^n, n {:.4}; rms difference from the readings {:.3} Pa",
            found.yield_stress, found.consistency, found.flow_index, found.residual
        )?;
    }
    if let (Some(viscosity), Some(point)) = (report.plastic_viscosity, report.yield_point) {
        writeln!(text, "# plastic viscosity {:.4} Pa s, yield point {point:.3} Pa", viscosity)?;
    }
    text += &fields(&report.least_squares);
    Ok(text)
}

fn fields(found: &MudFit) -> String {
    format!(
        "yield_stress = {:.6}\nconsistency = {:.7}\nflow_index = {:.6}\n",
        found.yield_stress, found.consistency, found.flow_index
    )
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::SurveyStation;

    use super::*;

    #[test]
    fn a_printed_survey_is_that_of_a_well() {
        let file = "MD (ft);Inc;Azi\n0;0;0\n1000,5;2,5;-1\nend;;\n";
        let read = survey(file.as_bytes(), SurveyOptions::default()).unwrap();
        let text = survey_text(&read).unwrap();
        #[derive(serde::Deserialize)]
        struct Well {
            survey: Vec<SurveyStation>,
        }
        let well: Well = toml::from_str(&text).unwrap();
        assert_eq!(well.survey, read.stations);
        insta::assert_snapshot!(text);
    }

    #[test]
    fn a_printed_mud_has_its_fits() {
        let readings =
            ["600=62", "300=38", "200=29", "100=19", "6=7", "3=6"].map(|text| reading(text).unwrap());
        insta::assert_snapshot!(mud_text(&fit(&readings).unwrap()).unwrap());
        assert!(reading("600").is_err() && reading("a=b").is_err());
    }
}
