//! Parts of a scenario from files of other programs, as TOML to put into one.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use clap::{Args, Subcommand};
use drillsweep_import::mud::{by_rp_13d, fit};
use drillsweep_import::{
    AssumedUnits, CellProblem, HoleImport, HoleOptions, MOST_BYTES, MudError, MudFit, MudReport, Reading,
    Survey, SurveyOptions, Tally, TallyLengths, TallyOptions, TallyOrder, UnderstoodColumn, hole, survey,
    tally,
};
use drillsweep_scenario::{HoleSection, Section};
use serde::Serialize;
use serde::de::DeserializeOwned;

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
    /// Read the components of a string from CSV, Excel or a WITSML tubular, and print `[[string.sections]]`.
    Tally(TallyArguments),
    /// Read casings and open hole from CSV, Excel or a WITSML geometry, and print `[[well.section]]`.
    Hole(HoleArguments),
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
struct TallyArguments {
    /// File with columns of description, length, outer and inner diameter, with headings.
    file: PathBuf,
    /// Direction of the list; absent means that the bit decides.
    #[arg(long, value_parser = PossibleValuesParser::new(["from_bit", "from_top"]).try_map(choice::<TallyOrder>))]
    order: Option<TallyOrder>,
    /// Meaning of a length next to a number of joints; absent means that cumulative lengths decide.
    #[arg(long, value_parser = PossibleValuesParser::new(["each", "total"]).try_map(choice::<TallyLengths>))]
    lengths: Option<TallyLengths>,
    /// Units of columns that have none: m, mm and kg/m, or ft, in and lb/ft.
    #[arg(long, value_parser = PossibleValuesParser::new(["si", "field"]).try_map(choice::<AssumedUnits>))]
    assumed_units: Option<AssumedUnits>,
    /// Sheet of a workbook, the first one if absent; or name of a WITSML tubular.
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// Print sections, components, columns, remarks and problems as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct HoleArguments {
    /// File with columns of upper end and diameter, with headings.
    file: PathBuf,
    /// Units of columns that have none: m, mm and kg/m, or ft, in and lb/ft.
    #[arg(long, value_parser = PossibleValuesParser::new(["si", "field"]).try_map(choice::<AssumedUnits>))]
    assumed_units: Option<AssumedUnits>,
    /// Sheet of a workbook, the first one if absent; or name of a WITSML geometry.
    #[arg(long, value_name = "NAME")]
    sheet: Option<String>,
    /// Print sections, columns, remarks and problems as JSON.
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
        Part::Tally(arguments) => show_tally(arguments),
        Part::Hole(arguments) => show_hole(arguments),
        Part::Mud(arguments) => show_mud(arguments),
    }
}

fn show_survey(arguments: &SurveyArguments) -> anyhow::Result<()> {
    let options =
        SurveyOptions { depth_unit: arguments.depth_unit.as_deref(), sheet: arguments.sheet.as_deref() };
    let read = survey(&bytes_of(&arguments.file)?, options).with_context(|| name_of(&arguments.file))?;
    show_read(&read, arguments.json, survey_text)
}

fn show_tally(arguments: &TallyArguments) -> anyhow::Result<()> {
    let options = TallyOptions {
        sheet: arguments.sheet.as_deref(),
        order: arguments.order,
        lengths: arguments.lengths,
        assumed_units: arguments.assumed_units,
    };
    let read = tally(&bytes_of(&arguments.file)?, options).with_context(|| name_of(&arguments.file))?;
    show_read(&read, arguments.json, tally_text)
}

fn show_hole(arguments: &HoleArguments) -> anyhow::Result<()> {
    let options = HoleOptions { sheet: arguments.sheet.as_deref(), assumed_units: arguments.assumed_units };
    let read = hole(&bytes_of(&arguments.file)?, options).with_context(|| name_of(&arguments.file))?;
    show_read(&read, arguments.json, hole_text)
}

/// A choice by its name.
pub(crate) fn choice<T: DeserializeOwned>(name: String) -> Result<T, serde_json::Error> {
    serde_json::from_value(name.into())
}

/// Name of a file in messages.
pub(crate) fn name_of(file: &Path) -> String {
    file.display().to_string()
}

/// Contents of a file of bounded size.
pub(crate) fn bytes_of(file: &Path) -> anyhow::Result<Vec<u8>> {
    let failed = || format!("cannot read {}", file.display());
    let size = std::fs::metadata(file).with_context(failed)?.len();
    if size > MOST_BYTES as u64 {
        bail!("{} has {size} bytes; {MOST_BYTES} is the limit", file.display());
    }
    std::fs::read(file).with_context(failed)
}

fn show_read<T: Serialize>(
    read: &T,
    is_json: bool,
    text: fn(&T) -> anyhow::Result<String>,
) -> anyhow::Result<()> {
    let text = if is_json { serde_json::to_string_pretty(read)? } else { text(read)? };
    print(text.trim_end());
    Ok(())
}

fn survey_text(read: &Survey) -> anyhow::Result<String> {
    let mut text = String::new();
    let deepest = read.stations.last().map_or(0.0, |station| station.measured_depth);
    writeln!(text, "# {} stations to {deepest:.2} m", read.stations.len())?;
    text += &comments(&read.columns, &read.remarks, &read.problems)?;
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

/// The part of a scenario with the sections of the string.
#[derive(Serialize)]
struct StringPart<'a> {
    string: Sections<'a>,
}

#[derive(Serialize)]
struct Sections<'a> {
    sections: &'a [Section],
}

fn tally_text(read: &Tally) -> anyhow::Result<String> {
    let mut text = String::new();
    let mass = read.mass.map_or_else(String::new, |mass| format!(", {mass:.0} kg in air"));
    writeln!(text, "# {} components of {:.2} m{mass}", read.components.len(), read.length)?;
    for component in &read.components {
        let kind = serde_json::to_value(component.kind)?;
        let words = component.recognised_by.map_or_else(String::new, |words| format!(" by `{words}`"));
        let kind = kind.as_str().unwrap_or_default();
        write!(text, "# row {}, `{}`: {kind}{words}", component.row, component.description)?;
        for remark in &component.remarks {
            write!(text, "; {remark}")?;
        }
        writeln!(text)?;
    }
    text += &comments(&read.columns, &read.remarks, &read.problems)?;
    text += &toml::to_string_pretty(&StringPart { string: Sections { sections: &read.sections } })?;
    Ok(text)
}

/// The part of a scenario with the sections of the hole.
#[derive(Serialize)]
struct WellPart<'a> {
    well: HoleSections<'a>,
}

#[derive(Serialize)]
struct HoleSections<'a> {
    section: &'a [HoleSection],
}

fn hole_text(read: &HoleImport) -> anyhow::Result<String> {
    let mut text = format!("# {} sections of the hole\n", read.sections.len());
    text += &comments(&read.columns, &read.remarks, &read.problems)?;
    text += &toml::to_string_pretty(&WellPart { well: HoleSections { section: &read.sections } })?;
    Ok(text)
}

/// Columns, remarks and problems of a file as comments.
pub(crate) fn comments(
    columns: &[UnderstoodColumn],
    remarks: &[String],
    problems: &[CellProblem],
) -> anyhow::Result<String> {
    let mut text = String::new();
    for column in columns {
        let unit = if column.unit.is_empty() { String::new() } else { format!(", in {}", column.unit) };
        let assumed = if column.is_assumed { ", not in the file" } else { "" };
        writeln!(
            text,
            "# {}: column {}, `{}`{unit}{assumed}",
            column.quantity, column.column, column.heading
        )?;
    }
    for remark in remarks {
        writeln!(text, "# {remark}")?;
    }
    for problem in problems {
        writeln!(text, "# not used: {problem}")?;
    }
    Ok(text)
}

fn show_mud(arguments: &MudArguments) -> anyhow::Result<()> {
    if let (Some(pv), Some(yp)) = (arguments.pv, arguments.yp) {
        let found = by_rp_13d(pv, yp, arguments.lsyp).ok_or(MudError::NoLaw)?;
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
    fn a_printed_tally_and_hole_are_those_of_a_scenario() {
        let file = "Item;Jts;Length each (m);OD (in);ID (in);Gauge (in);lb/ft;TJ OD (in);TJ ID (in);TJ length (m);Grade\n\
            Bit;1;0,3;12 1/4;;;;;;;\nNB stab;1;1,5;8;2 13/16;12,125;150;;;;\nFilter;1;2;8;x;;;;;;\n\
            Crane;1;2;8;3;;150;;;;\n5\" DP;10;9,4;5;4,276;;22,6;6 5/8;3 1/4;0,26;S-135\n";
        let read = tally(file.as_bytes(), TallyOptions::default()).unwrap();
        let text = tally_text(&read).unwrap();
        #[derive(serde::Deserialize)]
        struct Part {
            string: Sections,
        }
        #[derive(serde::Deserialize)]
        struct Sections {
            sections: Vec<Section>,
        }
        let part: Part = toml::from_str(&text).unwrap();
        assert_eq!(part.string.sections, read.sections);
        insta::assert_snapshot!(text);

        let file = "Section;From (m);ID (in);FF\ncasing;0;8,535;0,2\nopen hole;2594;8,5;0,3\n";
        let read = hole(file.as_bytes(), HoleOptions::default()).unwrap();
        let text = hole_text(&read).unwrap();
        #[derive(serde::Deserialize)]
        struct Wells {
            well: Holes,
        }
        #[derive(serde::Deserialize)]
        struct Holes {
            section: Vec<HoleSection>,
        }
        let wells: Wells = toml::from_str(&text).unwrap();
        assert_eq!(wells.well.section, read.sections);
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
