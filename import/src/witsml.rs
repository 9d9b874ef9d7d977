//! Trajectories, and tables of other objects, of WITSML 1.4.1.1 and 2.0 (Energistics). Names of elements differ between the versions in their
//! capitals alone.

use std::f64::consts::PI;

use drillsweep_scenario::SurveyStation;
use roxmltree::{Document, Node, ParsingOptions};

use crate::headings::Found;
use crate::number::number;
use crate::rows::{CellProblem, MOST_BYTES, MOST_PROBLEMS, MOST_STATIONS, Rows, UnderstoodColumn};

/// Reason for which a file is no WITSML of the kind that is read.
#[derive(Debug, thiserror::Error)]
pub enum WitsmlError {
    /// The file is too large.
    #[error(
        "the file has more than {MOST_BYTES} bytes, {MOST_STATIONS} stations or components, {MOST_ATTRIBUTES} attributes of an element or {MOST_NAMESPACES} namespaces"
    )]
    Size,
    /// It is no text.
    #[error("the text is not UTF-8: {0}")]
    Text(#[from] std::str::Utf8Error),
    /// It is no XML.
    #[error("{0}")]
    Xml(#[from] roxmltree::Error),
    /// It lacks an element.
    #[error("it has no {0}")]
    NoElement(&'static str),
}

/// Elements of an XML document that are read at most.
const MOST_ELEMENTS: u32 = 1_000_000;

/// Attributes of an element, and declarations of namespaces, that are read at most: the parser compares each with all others.
const MOST_ATTRIBUTES: usize = 100;
const MOST_NAMESPACES: usize = 1000;

/// Units of measure of WITSML with their size in metres or degrees.
const LENGTHS: [(&str, f64); 5] =
    [("m", 1.0), ("ft", 0.3048), ("ftUS", 1200.0 / 3937.0), ("ft[US]", 1200.0 / 3937.0), ("km", 1000.0)];
const ANGLES: [(&str, f64); 3] = [("dega", 1.0), ("deg", 1.0), ("rad", 180.0 / PI)];

/// True if a file is XML.
pub(crate) fn is_xml(bytes: &[u8]) -> bool {
    let is_blank = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, 0xef | 0xbb | 0xbf);
    bytes.iter().find(|byte| !is_blank(byte)) == Some(&b'<')
}

/// Stations of a trajectory; the `row` of a problem is a line of the file.
pub(crate) fn trajectory(bytes: &[u8]) -> Result<Rows, WitsmlError> {
    let document = document(bytes)?;
    let text = document.input_text();
    let is_station = |node: &Node<'_, '_>| is_named(node, "trajectoryStation");
    let (mut rows, mut problems, mut columns) = (Vec::new(), Vec::new(), Vec::new());
    let mut lines = Lines::new(text);
    for station in document.descendants().filter(is_station) {
        let line = lines.at(station.range().start);
        if problems.len() >= MOST_PROBLEMS {
            break;
        }
        if rows.len() > MOST_STATIONS {
            return Err(WitsmlError::Size);
        }
        let mut value = |name: &str, quantity: &'static str, units: &[(&str, f64)]| {
            let element = station.children().find(|node| is_named(node, name));
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
        return Err(WitsmlError::NoElement("trajectoryStation"));
    }
    Ok((rows, columns, problems))
}

/// A column of a table: elements below that of a row, such as `stabilizer/odBladeMx`, the first of which that is there has the value.
pub(crate) type Path = &'static [&'static str];

/// Tables of a document: elements of one name, such as `tubular`, with a row for each element of another name in them.
pub(crate) struct Table {
    /// Its name, or else its identifier.
    pub(crate) name: String,
    /// Elements that were found, in the order of the paths.
    pub(crate) columns: Vec<Option<Found>>,
    /// Lines from 0, with texts and their units in the order of the paths.
    pub(crate) rows: Vec<(usize, Vec<String>)>,
}

/// Tables of a document that have rows.
pub(crate) fn tables(
    bytes: &[u8],
    [table, row]: [&'static str; 2],
    paths: &[Path],
) -> Result<Vec<Table>, WitsmlError> {
    let document = document(bytes)?;
    let mut lines = Lines::new(document.input_text());
    let mut left = MOST_STATIONS;
    let mut tables = Vec::new();
    for node in document.descendants().filter(|node| is_named(node, table)) {
        let mut columns = vec![None; paths.len()];
        let mut rows = Vec::new();
        for component in node.children().filter(|node| is_named(node, row)) {
            left = left.checked_sub(1).ok_or(WitsmlError::Size)?;
            let line = lines.at(component.range().start);
            let mut cells = Vec::new();
            for (order, path) in paths.iter().enumerate() {
                let found = path.iter().find_map(|path| Some((*path, below(component, path)?)));
                cells.push(found.map_or_else(String::new, |(_, element)| text_with_unit(element)));
                if let Some((path, _)) = found {
                    columns[order].get_or_insert_with(|| element(order, path));
                }
            }
            rows.push((line, cells));
        }
        if !rows.is_empty() {
            let named = node.children().find(|node| is_named(node, "name") || is_named(node, "title"));
            let name = named.and_then(|name| name.text()).or_else(|| node.attribute("uid"));
            tables.push(Table { name: name.unwrap_or_default().trim().to_owned(), columns, rows });
        }
    }
    if tables.is_empty() { Err(WitsmlError::NoElement(row)) } else { Ok(tables) }
}

fn element(column: usize, path: &str) -> Found {
    let name = format!("<{path}>");
    Found { column, name: name.clone(), heading: name, unit: None }
}

/// The element with a text at the end of a path.
fn below<'a, 'i>(node: Node<'a, 'i>, path: &str) -> Option<Node<'a, 'i>> {
    let (first, rest) = path.split_once('/').map_or((path, None), |(first, rest)| (first, Some(rest)));
    let mut children = node.children().filter(|node| is_named(node, first));
    match rest {
        Some(rest) => children.find_map(|child| below(child, rest)),
        None => children.find(|child| child.text().is_some_and(|text| !text.trim().is_empty())),
    }
}

fn text_with_unit(element: Node<'_, '_>) -> String {
    let text = element.text().unwrap_or_default().trim();
    element.attribute("uom").map_or_else(|| text.to_owned(), |unit| format!("{text} {unit}"))
}

fn is_named(node: &Node<'_, '_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name().eq_ignore_ascii_case(name)
}

fn document(bytes: &[u8]) -> Result<Document<'_>, WitsmlError> {
    if bytes.len() > MOST_BYTES {
        return Err(WitsmlError::Size);
    }
    let text = std::str::from_utf8(bytes)?;
    let quotes = |part: &str| part.bytes().filter(|byte| matches!(byte, b'"' | b'\'')).count();
    if text.split('<').any(|part| quotes(part) > 2 * MOST_ATTRIBUTES)
        || text.matches("xmlns").count() > MOST_NAMESPACES
    {
        return Err(WitsmlError::Size);
    }
    // Without document types there are no entities that grow.
    let options =
        ParsingOptions { allow_dtd: false, nodes_limit: MOST_ELEMENTS, ..ParsingOptions::default() };
    Ok(Document::parse_with_options(text.trim_start_matches('\u{feff}'), options)?)
}

/// Lines of places in a text that follow each other, each byte counted once.
struct Lines<'a> {
    text: &'a [u8],
    line: usize,
    counted: usize,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        Self { text: text.as_bytes(), line: 0, counted: 0 }
    }

    /// Line of a place, from 0.
    fn at(&mut self, place: usize) -> usize {
        // Objects within objects of their kind go back, which no WITSML has; they keep the line.
        let between = self.text.get(self.counted..place).unwrap_or_default();
        self.line += between.iter().filter(|byte| **byte == b'\n').count();
        self.counted = self.counted.max(place);
        self.line
    }
}
