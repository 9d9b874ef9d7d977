//! Trajectories of WITSML 1.4.1.1 and 2.0 (Energistics).

use std::f64::consts::PI;

use drillsweep_scenario::SurveyStation;
use roxmltree::{Document, Node, ParsingOptions};

use crate::number::number;
use crate::rows::{CellProblem, MOST_BYTES, MOST_PROBLEMS, MOST_STATIONS, Rows, UnderstoodColumn};

/// Reason why a file is no trajectory.
#[derive(Debug, thiserror::Error)]
pub enum WitsmlError {
    /// The file is too large.
    #[error("the file has more than {MOST_BYTES} bytes or {MOST_STATIONS} stations")]
    Size,
    /// It is no text.
    #[error("the text is not UTF-8: {0}")]
    Text(#[from] std::str::Utf8Error),
    /// It is no XML.
    #[error("{0}")]
    Xml(#[from] roxmltree::Error),
    /// It has no stations.
    #[error("it has no trajectoryStation")]
    NoStations,
}

/// Elements of an XML document that are read at most.
const MOST_ELEMENTS: u32 = 2_000_000;

/// Units of measure of WITSML with their size in metres or degrees.
const LENGTHS: [(&str, f64); 5] =
    [("m", 1.0), ("ft", 0.3048), ("ftUS", 1200.0 / 3937.0), ("ft[US]", 1200.0 / 3937.0), ("km", 1000.0)];
const ANGLES: [(&str, f64); 3] = [("dega", 1.0), ("deg", 1.0), ("rad", 180.0 / PI)];

/// Stations of a trajectory; the `row` of a problem is a line of the file.
pub(crate) fn trajectory(bytes: &[u8]) -> Result<Rows, WitsmlError> {
    if bytes.len() > MOST_BYTES {
        return Err(WitsmlError::Size);
    }
    let text = std::str::from_utf8(bytes)?;
    // Without document types there are no entities that grow.
    let options =
        ParsingOptions { allow_dtd: false, nodes_limit: MOST_ELEMENTS, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text.trim_start_matches('\u{feff}'), options)?;
    let is_station = |node: &Node<'_, '_>| {
        node.is_element() && node.tag_name().name().eq_ignore_ascii_case("trajectoryStation")
    };
    let (mut rows, mut problems, mut columns) = (Vec::new(), Vec::new(), Vec::new());
    // Lines are counted along with the stations, each byte once.
    let (mut line, mut counted) = (0, 0);
    for station in document.descendants().filter(is_station) {
        let start = station.range().start;
        line += text.as_bytes()[counted..start].iter().filter(|byte| **byte == b'\n').count();
        counted = start;
        if problems.len() >= MOST_PROBLEMS {
            break;
        }
        if rows.len() > MOST_STATIONS {
            return Err(WitsmlError::Size);
        }
        let mut value = |name: &str, quantity: &'static str, units: &[(&str, f64)]| {
            let element = station
                .children()
                .find(|node| node.is_element() && node.tag_name().name().eq_ignore_ascii_case(name));
            let unit = element.and_then(|element| element.attribute("uom")).unwrap_or_default();
            let text = element.and_then(|element| element.text()).unwrap_or_default();
            let size = units.iter().find(|(symbol, _)| *symbol == unit).map(|(_, size)| *size);
            let (Some(value), Some(size)) = (number(text, false), size) else {
                let valid: Vec<_> = units.iter().map(|(symbol, _)| *symbol).collect();
                let problem = format!("<{name}> is no number with a `uom` of {}", valid.join(", "));
                problems.push(CellProblem::new(line, None, text, problem));
                return None;
            };
            if columns.iter().all(|column: &UnderstoodColumn| column.quantity != quantity) {
                let heading = format!("<{name}>");
                columns.push(UnderstoodColumn {
                    quantity,
                    column: heading.clone(),
                    heading,
                    unit: unit.to_owned(),
                    is_assumed: false,
                });
            }
            Some(value * size)
        };
        let values = [
            value("md", "measured_depth", &LENGTHS),
            value("incl", "inclination", &ANGLES),
            value("azi", "azimuth", &ANGLES),
        ];
        if let [Some(measured_depth), Some(inclination_deg), Some(azimuth_deg)] = values {
            rows.push((line, SurveyStation { measured_depth, inclination_deg, azimuth_deg }));
        }
    }
    if rows.is_empty() && problems.is_empty() {
        return Err(WitsmlError::NoStations);
    }
    Ok((rows, columns, problems))
}
