//! Sections of a hole: casings and open hole.

use std::ops::RangeInclusive;

use drillsweep_scenario::HoleSection;
use serde::Serialize;

use crate::error::ImportError;
use crate::measure::{AssumedUnits, Dimension, Value};
use crate::rows::{CellProblem, UnderstoodColumn};
use crate::sheet::{Cells, Column, Layout, Sheet};
use crate::witsml::WitsmlError;

/// Largest number of casings and open holes; their overlaps take time of its square.
const MOST_SECTIONS: usize = 500;

/// Ranges of depths and diameters \[m\], and of friction factors.
const DEPTHS: RangeInclusive<f64> = 0.0..=20_000.0;
const DIAMETERS: RangeInclusive<f64> = 1e-3..=5.0;
const FACTORS: RangeInclusive<f64> = 0.0..=10.0;

/// Longest name of a section \[characters\].
const LONGEST_NAME: usize = 100;

const NAME: usize = 0;
const TOP: usize = 1;
const BOTTOM: usize = 2;
const INNER: usize = 3;
const HOLE_SIZE: usize = 4;
const FACTOR: usize = 5;

static LAYOUT: Layout = Layout {
    columns: &[
        Column::optional(
            "name",
            None,
            &["description", "section", "name", "casing", "holesection", "type", "string"],
            &["typeHoleCasing"],
        ),
        Column::required(
            "from",
            Some(Dimension::Length),
            &[
                "from",
                "top",
                "topmd",
                "mdtop",
                "frommd",
                "mdfrom",
                "topdepth",
                "depthtop",
                "depthfrom",
                "fromdepth",
                "start",
                "startmd",
                "startdepth",
            ],
            &["mdTop", "sectionMdInterval/mdTop", "sectionMdInterval/mdMin"],
        ),
        Column::optional(
            "to",
            Some(Dimension::Length),
            &[
                "to",
                "bottom",
                "bottommd",
                "mdbottom",
                "tomd",
                "mdto",
                "bottomdepth",
                "depthbottom",
                "depthto",
                "todepth",
                "base",
                "basemd",
                "mdbase",
                "end",
                "endmd",
                "enddepth",
                "shoe",
                "shoemd",
                "mdshoe",
                "shoedepth",
                "setat",
                "settingdepth",
            ],
            &["mdBottom", "sectionMdInterval/mdBase", "sectionMdInterval/mdMax"],
        ),
        Column::optional(
            "inner_diameter",
            Some(Dimension::Diameter),
            &[
                "id",
                "innerdiameter",
                "insidediameter",
                "casingid",
                "idcasing",
                "casinginnerdiameter",
                "holediameter",
                "diameter",
                "effectivediameter",
            ],
            &["idSection"],
        ),
        Column::optional(
            "hole_size",
            Some(Dimension::Diameter),
            &["holesize", "openholesize", "openhole", "openholediameter", "bitsize", "sizeofhole", "holeid"],
            &[],
        ),
        Column::optional(
            "friction_factor",
            Some(Dimension::Number),
            &["frictionfactor", "ff", "friction", "frictioncoefficient", "factfric", "mu", "cof"],
            &["factFric"],
        ),
    ],
    wanted: "a hole: depth of the top and diameter, such as `From (m)`, `To (m)`, `ID (in)` or `Hole size (in)`",
    elements: ["wbGeometry", "wbGeometrySection"],
};

/// Choices of the reader that a file does not make.
#[derive(Debug, Clone, Copy, Default)]
pub struct HoleOptions<'a> {
    /// Sheet of a workbook, the first one if absent; or name of the WITSML `wbGeometry`, required if there are several.
    pub sheet: Option<&'a str>,
    /// Units of columns without one; absent means that they are refused.
    pub assumed_units: Option<AssumedUnits>,
}

/// A hole that was read, with the meanings of its columns.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct HoleImport {
    /// Sections in the order of depth, for `well.section`; at each depth the narrowest casing or hole of the file.
    pub sections: Vec<HoleSection>,
    /// Meaning of each column.
    pub columns: Vec<UnderstoodColumn>,
    /// Remarks on what was added or changed, in words.
    pub remarks: Vec<String>,
    /// Cells that could not be used, in the order of the file; rows without top or diameter are left out.
    pub problems: Vec<CellProblem>,
}

/// A casing or an open hole.
#[derive(Debug, Clone, PartialEq)]
struct Interval {
    name: String,
    top: f64,
    bottom: Option<f64>,
    diameter: f64,
    friction: Option<f64>,
}

/// The hole of a file: CSV, Excel, or a WITSML 1.4.1.1 or 2.0 geometry of a wellbore.
///
/// # Errors
/// The file cannot be read, has no headings of a hole, no unit of a column, or no usable row.
pub fn hole(bytes: &[u8], options: HoleOptions<'_>) -> Result<HoleImport, ImportError> {
    let sheet = match Sheet::read(bytes, options.sheet, &LAYOUT) {
        // WITSML 2.0 has another name for the object.
        Err(ImportError::Witsml(WitsmlError::NoElement(_))) => {
            Sheet::read(bytes, options.sheet, &LAYOUT_OF_2_0)?
        }
        sheet => sheet?,
    };
    let mut cells = Cells::new(&sheet, &LAYOUT, options.assumed_units)?;
    if !cells.has(INNER) && !cells.has(HOLE_SIZE) {
        return Err(ImportError::NoHeadings(LAYOUT.wanted));
    }
    let mut intervals = Vec::new();
    for at in 0..sheet.len() {
        if cells.is_full() {
            break;
        }
        if intervals.len() == MOST_SECTIONS {
            return Err(ImportError::TooMany { most: MOST_SECTIONS, rows: "sections" });
        }
        intervals.extend(interval(&mut cells, at)?);
    }
    let (columns, problems) = cells.understood();
    if intervals.is_empty() {
        return Err(ImportError::TooFew { count: 0, needed: 1, rows: "sections", problems });
    }
    let (sections, remarks) = innermost(intervals);
    Ok(HoleImport { sections, columns, remarks, problems })
}

static LAYOUT_OF_2_0: Layout = Layout { elements: ["wellboreGeometry", "wellboreGeometrySection"], ..LAYOUT };

/// A row of the sheet; `None` if it is empty or cannot be used.
fn interval(cells: &mut Cells<'_>, at: usize) -> Result<Option<Interval>, ImportError> {
    if [TOP, BOTTOM, INNER, HOLE_SIZE].iter().all(|column| cells.text(at, *column).is_empty()) {
        return Ok(None);
    }
    let mut number =
        |column, range| cells.number(at, column, range).map(|value: Option<Value>| value.map(Value::number));
    let (top, bottom) = (number(TOP, DEPTHS)?, number(BOTTOM, DEPTHS)?);
    // A casing has an inner diameter, an open hole the size of its bit.
    let diameter = match number(INNER, DIAMETERS)? {
        Some(inner) => Some(inner),
        None => number(HOLE_SIZE, DIAMETERS)?,
    };
    let friction = number(FACTOR, FACTORS)?;
    let name = cells.text(at, NAME).split_whitespace().collect::<Vec<_>>().join(" ");
    if top.is_none() {
        cells.require(at, TOP);
    }
    if diameter.is_none() && cells.text(at, HOLE_SIZE).is_empty() {
        cells.require(at, if cells.has(INNER) { INNER } else { HOLE_SIZE });
    }
    let is_open = cells.text(at, BOTTOM).is_empty();
    let Some((top, diameter)) = top.zip(diameter).filter(|_| is_open || bottom.is_some()) else {
        return Ok(None);
    };
    if bottom.is_some_and(|bottom| bottom <= top) {
        cells.note(at, BOTTOM, format!("it is not below the top, {top} m"));
        return Ok(None);
    }
    let name = name.chars().take(LONGEST_NAME).collect();
    Ok(Some(Interval { name, top, bottom, diameter, friction }))
}

/// The narrowest of the intervals at each depth, with remarks.
fn innermost(mut intervals: Vec<Interval>) -> (Vec<HoleSection>, Vec<String>) {
    let mut remarks = Vec::new();
    intervals.sort_by(|a, b| a.top.total_cmp(&b.top));
    // Without a bottom an interval ends at the next top.
    let tops: Vec<f64> = intervals.iter().map(|interval| interval.top).collect();
    let ends: Vec<f64> = intervals
        .iter()
        .map(|interval| {
            let next = tops.iter().copied().find(|top| *top > interval.top);
            interval.bottom.or(next).unwrap_or(f64::INFINITY)
        })
        .collect();
    let mut depths: Vec<f64> = tops.iter().chain(&ends).copied().filter(|depth| depth.is_finite()).collect();
    depths.sort_by(f64::total_cmp);
    depths.dedup();
    let deepest = ends.iter().copied().fold(0.0, f64::max);
    let mut sections: Vec<HoleSection> = Vec::new();
    let (mut current, mut overlaps) = (None, 0);
    for depth in depths.into_iter().filter(|depth| *depth < deepest) {
        let covering = intervals.iter().zip(&ends).enumerate();
        let covering: Vec<usize> = covering
            .filter(|(_, (interval, end))| interval.top <= depth && depth < **end)
            .map(|(at, _)| at)
            .collect();
        let narrowest =
            covering.iter().copied().min_by(|a, b| intervals[*a].diameter.total_cmp(&intervals[*b].diameter));
        overlaps += usize::from(covering.len() > 1);
        let Some(at) = narrowest else {
            remarks.push(format!("the file has no section at {depth} m: the one above goes on"));
            continue;
        };
        if current == Some(at) {
            continue;
        }
        current = Some(at);
        let Interval { name, diameter, friction, .. } = &intervals[at];
        sections.push(HoleSection {
            name: name.clone(),
            from: depth,
            hole_diameter: Some(*diameter),
            static_friction: *friction,
            dynamic_friction: *friction,
        });
    }
    if overlaps > 0 {
        remarks.push(format!("sections overlap at {overlaps} depths: the narrowest one counts there"));
    }
    if sections.iter().any(|section| section.dynamic_friction.is_some()) {
        remarks.push("friction factors are taken as static and dynamic coefficients".to_owned());
    }
    if let Some(first) = sections.first().filter(|first| first.from > 0.0) {
        remarks.push(format!("above {} m the hole is that of `well.hole_diameter`", first.from));
    }
    (sections, remarks)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> HoleImport {
        hole(text.as_bytes(), HoleOptions::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Upper ends \[m\], diameters \[in\] and friction factors.
    fn sections(hole: &HoleImport) -> Vec<(f64, f64, Option<f64>)> {
        let inches = |metres: f64| (metres / 0.0254 * 1e6).round() / 1e6;
        let of = |section: &HoleSection| {
            assert_eq!(section.static_friction, section.dynamic_friction);
            (section.from, inches(section.hole_diameter.unwrap()), section.dynamic_friction)
        };
        hole.sections.iter().map(of).collect()
    }

    #[test]
    fn one_hole_in_four_files_has_one_meaning() {
        // A 9 5/8 in casing to 2,594 m within a 13 3/8 in one to 1,100 m, and 8 1/2 in open hole.
        let section = |kind: &str, top: &str, bottom: &str, id: &str, factor: &str| {
            format!(
                "<wbGeometrySection uid=\"{kind}{id}\"><typeHoleCasing>{kind}</typeHoleCasing><mdTop uom=\"m\">{top}</mdTop><mdBottom uom=\"m\">{bottom}</mdBottom>\
                 <idSection uom=\"in\">{id}</idSection>{factor}</wbGeometrySection>"
            )
        };
        let factor = |factor: &str| format!("<factFric>{factor}</factFric>");
        let xml = format!(
            "<wbGeometrys xmlns=\"http://www.witsml.org/schemas/1series\" version=\"1.4.1.1\"><wbGeometry uid=\"g\">{}{}{}</wbGeometry></wbGeometrys>",
            section("casing", "0", "1100", "12.415", &factor("0.2")),
            section("casing", "0", "2594", "8.535", &factor("0.2")),
            section("open hole", "2594", "3438", "8.5", &factor("0.3"))
        );
        let later = xml
            .replace("wbGeometrys", "objects")
            .replace("wbGeometry", "WellboreGeometry")
            .replace("mdTop", "MdTop")
            .replace("<MdTop", "<SectionMdInterval><MdTop")
            .replace("mdBottom", "MdBase")
            .replace("</MdBase>", "</MdBase></SectionMdInterval>");
        let files = [
            "Section,From (m),To (m),ID (in),Hole size (in),FF\n13 3/8 casing,0,1100,12.415,17.5,0.2\n9 5/8 casing,0,2594,8.535,12 1/4,0.2\nopen hole,2594,3438,,8 1/2,0.3\n",
            "Name;Top MD [m];Hole diameter [mm];Friction factor\n9 5/8;0;216,789;0,2\nopen hole;2594;215,9;0,3\n",
            &xml,
            &later,
        ];
        for file in files {
            let hole = read(file);
            assert!(hole.problems.is_empty(), "{:?}: {file}", hole.problems);
            let expected = [(0.0, 8.535, Some(0.2)), (2594.0, 8.5, Some(0.3))];
            assert_eq!(sections(&hole), expected, "{file}");
        }
        assert_eq!(
            read(files[0]).remarks,
            [
                "sections overlap at 1 depths: the narrowest one counts there",
                "friction factors are taken as static and dynamic coefficients"
            ]
        );
    }

    #[test]
    fn a_liner_hangs_within_its_casing_and_gaps_are_remarked_on() {
        let text = "Type,Top (ft),Shoe (ft),ID (in)\nriser,100,500,19.5\ncasing,600,5000,12.415\nliner,4800,8000,8.535\n";
        let hole = read(text);
        assert_eq!(
            hole.sections.iter().map(|section| (section.name.as_str(), section.from)).collect::<Vec<_>>(),
            [("riser", 30.48), ("casing", 182.88), ("liner", 1463.04)]
        );
        assert_eq!(
            hole.remarks,
            [
                "the file has no section at 152.4 m: the one above goes on",
                "sections overlap at 1 depths: the narrowest one counts there",
                "above 30.48 m the hole is that of `well.hole_diameter`"
            ]
        );
    }

    #[test]
    fn cells_that_were_not_understood_have_row_and_column() {
        let text = "Name,From (m),To (m),ID (in)\na,0,10,x\nb,,10,9\nc,20,10,9\nd,-1,10,9\ne,0,nan,9\nf,0,10,9\ng,0,10,1e9\n,,,\n";
        let hole = read(text);
        let problems: Vec<_> = hole
            .problems
            .iter()
            .map(|problem| (problem.row, problem.column.as_deref().unwrap_or_default()))
            .collect();
        assert_eq!(problems, [(2, "D"), (3, "B"), (4, "C"), (5, "B"), (6, "C"), (8, "D")]);
        assert_eq!(hole.sections.len(), 1);
    }

    #[test]
    fn hostile_holes_end_in_an_error() {
        let many = format!("From (m);ID (in)\n{}", "0;9\n".repeat(MOST_SECTIONS + 1));
        let error = hole(many.as_bytes(), HoleOptions::default());
        assert!(matches!(error, Err(ImportError::TooMany { most: MOST_SECTIONS, .. })));
        for text in [
            "",
            "<a/>",
            "<!DOCTYPE a [<!ENTITY b \"c\">]><wbGeometry>&b;</wbGeometry>",
            "<wbGeometry><wbGeometrySection/></wbGeometry>",
            "From (m);To (m)\n0;10\n",
            "From;ID (in)\n0;9\n",
            "From (m);ID (in)\nnan;inf\n",
        ] {
            assert!(hole(text.as_bytes(), HoleOptions::default()).is_err(), "{text}");
        }
    }
}
