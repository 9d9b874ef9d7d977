//! Tallies: components of a string.

mod layout;
mod row;
#[cfg(test)]
mod tests;

use std::cmp::Ordering;
use std::fmt;

use drillsweep_scenario::{Section, SectionKind, WrittenSection};
use serde::{Deserialize, Serialize};

use crate::error::ImportError;
use crate::measure::AssumedUnits;
use crate::rows::{CellProblem, MOST_PROBLEMS, UnderstoodColumn};
use crate::sheet::{Cells, Sheet};
use crate::tally::layout::{JOINT_LENGTH, LAYOUT, LENGTH, LENGTH_EACH, LENGTH_TOTAL, WEIGHT};
pub use crate::tally::row::UnderstoodComponent;
use crate::tally::row::{LEAST_BLADE, ROUNDING, ROUNDING_OF_PIECE, Row};

/// Largest number of components.
pub const MOST_COMPONENTS: usize = 5_000;

/// Direction in which a tally lists its components.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TallyOrder {
    /// From the bit up.
    FromBit,
    /// From the top down.
    FromTop,
}

/// Meaning of a length next to a number of joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TallyLengths {
    /// Length of one joint.
    Each,
    /// Length of all joints of the row.
    Total,
}

/// Choices of the reader that a file does not make.
#[derive(Debug, Clone, Copy, Default)]
pub struct TallyOptions<'a> {
    /// Sheet of a workbook, the first one if absent; or name of the WITSML `tubular`, required if there are several.
    pub sheet: Option<&'a str>,
    /// Direction of the list; absent means that the bit decides.
    pub order: Option<TallyOrder>,
    /// Meaning of a column `Length` next to a number of joints; absent means that cumulative lengths decide.
    pub lengths: Option<TallyLengths>,
    /// Units of columns without one; absent means that they are refused.
    pub assumed_units: Option<AssumedUnits>,
}

/// A tally that was read, with the meanings of its rows and columns.
#[derive(Debug, Clone, PartialEq, Serialize, utoipa::ToSchema)]
pub struct Tally {
    /// Sections from the top down, for `string.sections`; equal rows that follow each other are one section.
    #[schema(value_type = Vec<WrittenSection>)]
    pub sections: Vec<Section>,
    /// Length of all sections \[m\].
    pub length: f64,
    /// Mass of all sections in air \[kg\]; absent unless each has a weight.
    pub mass: Option<f64>,
    /// Direction of the file's list.
    pub order: TallyOrder,
    /// Meaning of each row that is part of the string, from the top down.
    pub components: Vec<UnderstoodComponent>,
    /// Meaning of each column.
    pub columns: Vec<UnderstoodColumn>,
    /// Remarks on the whole, in words.
    pub remarks: Vec<String>,
    /// Cells that could not be used, in the order of the file; rows without length or diameters are left out.
    pub problems: Vec<CellProblem>,
}

/// The tally of a file: CSV, Excel, or a WITSML 1.4.1.1 or 2.0 tubular.
///
/// # Errors
/// The file cannot be read, has no headings of a tally, no unit of a column, no usable row, or leaves its direction or the meaning of its lengths open.
pub fn tally(bytes: &[u8], options: TallyOptions<'_>) -> Result<Tally, ImportError> {
    let sheet = Sheet::read(bytes, options.sheet, &LAYOUT)?;
    let mut cells = Cells::new(&sheet, &LAYOUT, options.assumed_units)?;
    if cells.lacks_lengths() {
        return Err(ImportError::NoHeadings(LAYOUT.wanted));
    }
    let mut rows = Vec::new();
    for at in 0..sheet.len() {
        if cells.is_full() {
            break;
        }
        if rows.len() == MOST_COMPONENTS {
            return Err(ImportError::TooMany { most: MOST_COMPONENTS, rows: "components" });
        }
        rows.extend(Row::read(&mut cells, at)?);
    }
    if rows.is_empty() {
        let problems = cells.understood().1;
        return Err(ImportError::TooFew { count: 0, needed: 1, rows: "components", problems });
    }
    let mut remarks = columns_remarks(&cells);
    settle_lengths(&mut rows, options.lengths, cells.heading(LENGTH))?;
    remarks.extend(steps(&rows).map(|step| step.to_string()).take(MOST_PROBLEMS));
    if rows.iter().all(|row| row.sequence.is_some()) {
        rows.sort_by(|a, b| a.sequence.partial_cmp(&b.sequence).unwrap_or(Ordering::Equal));
    }
    let order = order(&rows, options.order)?;
    if order == TallyOrder::FromTop {
        rows.reverse();
    }
    complete_bit(&mut rows);
    rows.reverse();
    if rows.last().is_some_and(|row| row.kind != SectionKind::Bit) {
        remarks.push("the lowest component is no bit".to_owned());
    }
    let mut sections: Vec<Section> = Vec::new();
    let mut components = Vec::new();
    for mut row in rows {
        let Some(section) = row.section() else {
            cells.problems.push(CellProblem::new(row.place, None, &row.description, "it has no diameters"));
            continue;
        };
        components.push(row.understood());
        match sections.last_mut() {
            Some(last) if (Section { count: section.count, ..last.clone() }) == section => {
                last.count += section.count;
            }
            _ => sections.push(section),
        }
    }
    let (columns, problems) = cells.understood();
    if sections.is_empty() {
        return Err(ImportError::TooFew { count: 0, needed: 1, rows: "components", problems });
    }
    let mass = |section: &Section| section.mass_per_length.map(|mass| mass * section.whole_length());
    Ok(Tally {
        length: sections.iter().map(Section::whole_length).sum(),
        mass: sections.iter().map(mass).sum(),
        sections,
        order,
        components,
        columns,
        remarks,
        problems,
    })
}

impl Cells<'_> {
    fn lacks_lengths(&self) -> bool {
        [LENGTH, LENGTH_EACH, LENGTH_TOTAL].into_iter().all(|column| !self.has(column))
    }
}

/// Remarks on the meanings of columns.
fn columns_remarks(cells: &Cells<'_>) -> Vec<String> {
    let mut remarks = Vec::new();
    if cells.heading(WEIGHT).to_lowercase().contains("nom") {
        remarks.push(format!("`{}`: a nominal weight leaves tool joints out", cells.heading(WEIGHT)));
    }
    if cells.has(JOINT_LENGTH) {
        remarks.push(format!(
            "`{}` is taken as the length of the joint at each end",
            cells.heading(JOINT_LENGTH)
        ));
    }
    remarks
}

/// Gives lengths without a stated meaning theirs: that of the option, or the one that fits the cumulative lengths.
fn settle_lengths(rows: &mut [Row], chosen: Option<TallyLengths>, heading: &str) -> Result<(), ImportError> {
    let is_open =
        |row: &Row| row.length.is_some() && row.each.or(row.total).is_none() && row.count.unwrap_or(1) > 1;
    if !rows.iter().any(is_open) {
        return Ok(());
    }
    let settle = |rows: &mut [Row], meaning: TallyLengths| {
        for row in rows {
            (row.each, row.total) = match meaning {
                TallyLengths::Each => (row.length, row.total.filter(|_| row.length.is_none())),
                TallyLengths::Total => (row.each.filter(|_| row.length.is_none()), row.length),
            };
        }
    };
    if let Some(meaning) = chosen {
        settle(rows, meaning);
        return Ok(());
    }
    settle(rows, TallyLengths::Each);
    let as_each = steps(rows).count();
    settle(rows, TallyLengths::Total);
    let as_total = steps(rows).count();
    let open = || ImportError::Open {
        option: "lengths",
        open: format!("`{heading}` next to a number of joints may be the length of one joint or of all"),
        valid: "each or total".to_owned(),
    };
    match as_each.cmp(&as_total) {
        Ordering::Less => settle(rows, TallyLengths::Each),
        Ordering::Greater => {}
        Ordering::Equal => return Err(open()),
    }
    Ok(())
}

/// A step of the cumulative length that is not the length of its row.
struct Step {
    row: usize,
    length: f64,
    step: f64,
}

impl fmt::Display for Step {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { row, length, step } = self;
        write!(
            formatter,
            "row {row}: the length is {length:.2} m, the cumulative length changes by {step:.2} m"
        )
    }
}

/// Steps of the cumulative lengths that disagree with the lengths, between rows that follow each other in the file. A cumulative length that grows
/// down the list ends with its row, one that falls begins with it.
fn steps(rows: &[Row]) -> impl Iterator<Item = Step> {
    let pairs = || rows.windows(2).filter(|pair| pair[1].at == pair[0].at + 1);
    let step = |pair: &[Row]| Some(pair[1].cumulative? - pair[0].cumulative?);
    let grows = pairs().filter_map(step).map(f64::signum).sum::<f64>() >= 0.0;
    pairs().filter_map(move |pair| {
        let row = if grows { &pair[1] } else { &pair[0] };
        let (step, length) = (step(pair)?.abs(), row.whole_length());
        let rounding = ROUNDING + ROUNDING_OF_PIECE * f64::from(row.pieces().0);
        ((step - length).abs() > rounding).then_some(Step { row: row.place + 1, length, step })
    })
}

/// Direction of the rows: the given one, or that of the bit.
fn order(rows: &[Row], given: Option<TallyOrder>) -> Result<TallyOrder, ImportError> {
    let is_bit = |row: Option<&Row>| row.is_some_and(|row| row.kind == SectionKind::Bit);
    match (given, is_bit(rows.first()), is_bit(rows.last())) {
        (Some(order), ..) => Ok(order),
        (None, true, is_last) if !is_last || rows.len() == 1 => Ok(TallyOrder::FromBit),
        (None, false, true) => Ok(TallyOrder::FromTop),
        // A component with sequence 1 entered the hole first (WITSML 1.4.1.1, cs_tubularComponent).
        (None, false, false) if rows.iter().all(|row| row.sequence.is_some()) => Ok(TallyOrder::FromBit),
        (None, is_first, _) => Err(ImportError::Open {
            option: "order",
            open: if is_first {
                "the first and the last component are bits".to_owned()
            } else {
                "neither the first nor the last component is a bit".to_owned()
            },
            valid: "from_bit or from_top".to_owned(),
        }),
    }
}

/// Fills in the body of the bit, the first row, from the component above it: tallies often give its gauge alone.
fn complete_bit(rows: &mut [Row]) {
    let [bit, above, ..] = rows else { return };
    if bit.kind != SectionKind::Bit {
        return;
    }
    let Some((outer, inner)) = above.outer.zip(above.inner) else { return };
    let is_body =
        bit.outer.is_some_and(|own| own < outer + LEAST_BLADE || bit.gauge.is_some_and(|gauge| gauge > own));
    if !is_body {
        bit.gauge = bit.gauge.or(bit.outer);
        bit.outer = Some(outer);
        bit.remarks.push(format!("the body has the outer diameter of the component above, {outer} m"));
    }
    if bit.inner.is_none_or(|own| bit.outer.is_some_and(|outer| own >= outer)) {
        bit.inner = Some(inner);
        bit.remarks.push(format!("the body has the inner diameter of the component above, {inner} m"));
    }
}
