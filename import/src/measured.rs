//! Hook loads and torques measured at the surface.

use std::ops::RangeInclusive;

use serde::Serialize;

use crate::error::ImportError;
use crate::measure::{AssumedUnits, Dimension, Value};
use crate::rows::{CellProblem, UnderstoodColumn};
use crate::sheet::{Cells, Column, Layout, Sheet};

/// Largest number of measured points.
const MOST_POINTS: usize = 500;

/// Ranges of depths \[m\], forces \[N\] and torques \[N m\].
const DEPTHS: RangeInclusive<f64> = 0.0..=20_000.0;
const FORCES: RangeInclusive<f64> = -1e8..=1e8;
const TORQUES: RangeInclusive<f64> = -1e7..=1e7;

const DEPTH: usize = 0;
const MODE: usize = 1;
const HOOK_LOAD: usize = 2;
const TORQUE: usize = 3;
/// Columns of hook loads of one motion each.
const OF_MODES: [(usize, &str); 3] = [(4, "pick_up"), (5, "slack_off"), (6, "rotate")];

static LAYOUT: Layout = Layout {
    columns: &[
        Column::required(
            "bit_depth",
            Some(Dimension::Length),
            &["bitdepth", "depth", "md", "measureddepth", "bitmd", "depthofbit", "holedepth", "mdbit"],
            &[],
        ),
        Column::optional(
            "mode",
            None,
            &["mode", "motion", "operation", "activity", "state", "rigstate", "type"],
            &[],
        ),
        Column::optional(
            "hook_load",
            Some(Dimension::Force),
            &["hookload", "hkld", "hl", "hook", "measuredhookload", "hookloadmax", "weight"],
            &[],
        ),
        Column::optional(
            "torque",
            Some(Dimension::Torque),
            &["torque", "surfacetorque", "tq", "trq", "rotatingtorque", "torqueoffbottom", "offbottomtorque"],
            &[],
        ),
        Column::optional(
            "pick_up",
            Some(Dimension::Force),
            &["pickup", "pickupweight", "pu", "puw", "up", "upweight", "pickuphookload"],
            &[],
        ),
        Column::optional(
            "slack_off",
            Some(Dimension::Force),
            &["slackoff", "slackoffweight", "so", "sow", "down", "downweight", "slackoffhookload"],
            &[],
        ),
        Column::optional(
            "rotate",
            Some(Dimension::Force),
            &[
                "rotate",
                "rotating",
                "rotatingweight",
                "rot",
                "rotw",
                "freerotating",
                "freerotatingweight",
                "frw",
            ],
            &[],
        ),
    ],
    wanted: "measured hook loads: bit depth with `Pick up`, `Slack off`, `Rotating` and `Torque`, or with `Mode`, `Hook load` and `Torque`",
    elements: ["", ""],
};

/// Names of motions in files, without signs, with those of scenarios.
const MODES: [(&[&str], &str); 6] = [
    (&["pickup", "pu", "up", "pull", "pooh", "pullingout", "tripout", "trippingout"], "pick_up"),
    (&["slackoff", "so", "down", "lower", "rih", "runin", "runningin", "tripin", "trippingin"], "slack_off"),
    (&["rotate", "rotating", "rot", "offbottom", "rotatingoffbottom", "freerotating"], "rotate"),
    (&["drill", "drilling", "onbottom", "rotatingonbottom", "rotarydrilling"], "drill"),
    (&["slide", "sliding", "slidedrilling"], "slide"),
    (&["ream", "reaming", "backream", "backreaming"], "ream"),
];

/// Choices of the reader that a file does not make.
#[derive(Debug, Clone, Copy, Default)]
pub struct MeasuredOptions<'a> {
    /// Sheet of a workbook, the first one if absent.
    pub sheet: Option<&'a str>,
    /// Units of columns without one; absent means that they are refused.
    pub assumed_units: Option<AssumedUnits>,
}

/// A hook load, a torque or both at one bit depth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredRow {
    /// Measured depth of the bit \[m\].
    pub bit_depth: f64,
    /// Motion: `pick_up`, `slack_off`, `rotate`, `drill`, `slide` or `ream`.
    pub mode: &'static str,
    /// Hook load \[N\]; absent if not measured.
    pub hook_load: Option<f64>,
    /// Surface torque \[N m\]; absent if not measured.
    pub torque: Option<f64>,
}

/// Measured points that were read, with the meanings of their columns.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredImport {
    /// Points in the order of the file.
    pub points: Vec<MeasuredRow>,
    /// Meaning of each column.
    pub columns: Vec<UnderstoodColumn>,
    /// Cells that could not be used, in the order of the file.
    pub problems: Vec<CellProblem>,
}

/// Measured points of a file, CSV or Excel: a row a point with its motion, or a row a depth with a column for each motion; its torque is then that of
/// rotation off bottom.
///
/// # Errors
/// The file cannot be read, has no headings of hook loads, no unit of a column, or no usable row.
pub fn measured(bytes: &[u8], options: MeasuredOptions<'_>) -> Result<MeasuredImport, ImportError> {
    let sheet = Sheet::read(bytes, options.sheet, &LAYOUT)?;
    let mut cells = Cells::new(&sheet, &LAYOUT, options.assumed_units)?;
    let has_modes = OF_MODES.iter().any(|(column, _)| cells.has(*column));
    if !has_modes && !(cells.has(MODE) && (cells.has(HOOK_LOAD) || cells.has(TORQUE))) {
        return Err(ImportError::NoHeadings(LAYOUT.wanted));
    }
    let mut points = Vec::new();
    for at in 0..sheet.len() {
        if cells.is_full() {
            break;
        }
        read_row(&mut cells, at, &mut points)?;
        if points.len() > MOST_POINTS {
            return Err(ImportError::TooMany { most: MOST_POINTS, rows: "measured points" });
        }
    }
    let (columns, problems) = cells.understood();
    if points.is_empty() {
        return Err(ImportError::TooFew { count: 0, needed: 1, rows: "measured points", problems });
    }
    Ok(MeasuredImport { points, columns, problems })
}

/// Adds the points of a row; none if it is empty or cannot be used.
fn read_row(cells: &mut Cells<'_>, at: usize, points: &mut Vec<MeasuredRow>) -> Result<(), ImportError> {
    if LAYOUT.columns.iter().enumerate().all(|(column, _)| cells.text(at, column).is_empty()) {
        return Ok(());
    }
    let mut number =
        |column, range| cells.number(at, column, range).map(|value: Option<Value>| value.map(Value::number));
    let bit_depth = number(DEPTH, DEPTHS)?;
    let (hook_load, torque) = (number(HOOK_LOAD, FORCES)?, number(TORQUE, TORQUES)?);
    let mut of_modes = Vec::new();
    for (column, mode) in OF_MODES {
        of_modes.extend(number(column, FORCES)?.map(|load| (mode, load)));
    }
    let Some(bit_depth) = bit_depth else {
        cells.require(at, DEPTH);
        return Ok(());
    };
    let mut add = |mode, hook_load: Option<f64>, torque: Option<f64>| {
        if hook_load.is_some() || torque.is_some() {
            points.push(MeasuredRow { bit_depth, mode, hook_load, torque });
        }
    };
    let text = cells.text(at, MODE);
    if text.is_empty() {
        let has_rotating = of_modes.iter().any(|(mode, _)| *mode == "rotate");
        for (mode, load) in of_modes {
            add(mode, Some(load), torque.filter(|_| mode == "rotate"));
        }
        if !has_rotating {
            add("rotate", None, torque);
        }
        if hook_load.is_some() {
            cells.require(at, MODE);
        }
        return Ok(());
    }
    let plain: String = text.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect();
    match MODES.iter().find(|(names, _)| names.contains(&plain.as_str())) {
        Some((_, mode)) => add(mode, hook_load, torque),
        None => {
            let valid = "pick up, slack off, rotate, drill, slide or ream";
            cells.note(at, MODE, format!("no motion of a string: {valid}"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<MeasuredImport, ImportError> {
        measured(text.as_bytes(), MeasuredOptions::default())
    }

    fn point(bit_depth: f64, mode: &'static str, hook_load: Option<f64>, torque: Option<f64>) -> MeasuredRow {
        MeasuredRow { bit_depth, mode, hook_load, torque }
    }

    #[test]
    fn a_row_a_depth_and_a_row_a_point_have_one_meaning() {
        let wide = "Depth (m),PU (kN),SO (kN),ROT (kN),Torque (kN.m)\n1500,620,510,560,7.5\n2800,,640,,\n";
        let long = "Bit depth [m];Operation;Hook load [kN];Surface torque [kNm]\n1500;Pick-up;620;\n1500;slack off;510;\n1500;Rotating off bottom;560;7,5\n2800;SO;640;\n";
        let expected = [
            point(1500.0, "pick_up", Some(620e3), None),
            point(1500.0, "slack_off", Some(510e3), None),
            point(1500.0, "rotate", Some(560e3), Some(7.5e3)),
            point(2800.0, "slack_off", Some(640e3), None),
        ];
        for text in [wide, long] {
            let found = read(text).unwrap();
            assert!(found.problems.is_empty(), "{:?}", found.problems);
            assert_eq!(found.points, expected, "{text}");
        }
    }

    #[test]
    fn field_units_and_weights_of_masses_are_forces() {
        let found = read("MD (ft),Mode,Hookload (klb),Torque (kft-lb)\n10000,rotate,200,15\n").unwrap();
        let [row] = &found.points[..] else { panic!("{found:?}") };
        assert!((row.bit_depth - 3048.0).abs() < 1e-9);
        assert!((row.hook_load.unwrap() / 889_644.323_052_1 - 1.0).abs() < 1e-12, "{row:?}");
        assert!((row.torque.unwrap() / 20_337.269_224_971 - 1.0).abs() < 1e-12, "{row:?}");
        let tonnes = read("MD (m),PU (t)\n1000,100\n").unwrap();
        assert_eq!(tonnes.points, [point(1000.0, "pick_up", Some(980_665.0), None)]);
    }

    #[test]
    fn cells_without_a_meaning_are_problems_and_files_without_any_are_refused() {
        let found =
            read("Depth (m),Mode,Hook load (kN)\n1000,flying,500\n1100,,500\nx,PU,500\n1200,PU,500\n")
                .unwrap();
        assert_eq!(found.points, [point(1200.0, "pick_up", Some(5e5), None)]);
        let problems: Vec<_> =
            found.problems.iter().map(|problem| (problem.row, problem.text.as_str())).collect();
        assert_eq!(problems, [(2, "flying"), (3, ""), (4, "x")]);
        assert!(matches!(read("Depth,PU\n1000,500\n"), Err(ImportError::NoUnit { .. })));
        assert!(matches!(read("Depth (m),Pressure (bar)\n1000,500\n"), Err(ImportError::NoHeadings(_))));
        assert!(matches!(read("Depth (m),PU (kN)\n1000,x\n"), Err(ImportError::TooFew { .. })));
        let many: String = (0..600).map(|i| format!("{i},500\n")).collect();
        assert!(matches!(read(&format!("Depth (m),PU (kN)\n{many}")), Err(ImportError::TooMany { .. })));
    }
}
