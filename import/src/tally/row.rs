//! Rows of a tally, and the sections that they make.

use std::f64::consts::FRAC_PI_4;
use std::ops::RangeInclusive;

use drillsweep_scenario::{Grade, Section, SectionKind, ToolJoint};
use serde::Serialize;

use crate::error::ImportError;
use crate::kind::kind;
use crate::measure::Value;
use crate::sheet::Cells;
use crate::tally::layout::{
    COUNT, CUMULATIVE, DESCRIPTION, GAUGE, GRADE, INNER, JOINT_INNER, JOINT_LENGTH, JOINT_OUTER, LENGTH,
    LENGTH_EACH, LENGTH_TOTAL, OUTER, SEQUENCE, TYPE, WEIGHT,
};

/// Ranges of a piece's length, of a row's, and of its diameters \[m\], of a mass or mass per length, and of a number of pieces.
const LENGTHS: RangeInclusive<f64> = 1e-3..=20_000.0;
const DIAMETERS: RangeInclusive<f64> = 1e-3..=2.0;
const BORES: RangeInclusive<f64> = 0.0..=2.0;
const MASSES: RangeInclusive<f64> = 1e-3..=1e7;
const COUNTS: RangeInclusive<f64> = 1.0..=10_000.0;

/// Difference of diameters below which blades are none \[m\].
pub(super) const LEAST_BLADE: f64 = 1e-3;

/// Density of steel \[kg/m3\] with which weights are compared, and the ratios that are remarked on: published motors and bits weigh up to 1.8
/// times their dimensions.
const STEEL: f64 = 7850.0;
const USUAL_WEIGHTS: RangeInclusive<f64> = 0.5..=2.0;

/// Rounding of lengths in files \[m\]: of a cumulative length, and of the length of a piece.
pub(super) const ROUNDING: f64 = 0.02;
pub(super) const ROUNDING_OF_PIECE: f64 = 0.005;

/// Longest name of a section \[characters\].
const LONGEST_NAME: usize = 100;

/// Meaning of a row of a tally.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, utoipa::ToSchema)]
pub struct UnderstoodComponent {
    /// Row, from 1, as editors and spreadsheets count; the line of a WITSML file.
    pub row: usize,
    /// Description in the file.
    pub description: String,
    /// Kind of the section.
    pub kind: SectionKind,
    /// Words of the description that decide the kind; absent if none does, which makes the component a collar.
    pub recognised_by: Option<&'static str>,
    /// Remarks on what was added, changed or left out, in words.
    pub remarks: Vec<String>,
}

/// A row as it was read.
pub(super) struct Row {
    /// Row of the file, and place among its rows, from 0.
    pub(super) place: usize,
    pub(super) at: usize,
    pub(super) description: String,
    pub(super) kind: SectionKind,
    pub(super) recognised_by: Option<&'static str>,
    pub(super) sequence: Option<f64>,
    pub(super) count: Option<u32>,
    /// Lengths of the columns: of unknown meaning, of a piece, of the row.
    pub(super) length: Option<f64>,
    pub(super) each: Option<f64>,
    pub(super) total: Option<f64>,
    pub(super) cumulative: Option<f64>,
    /// Diameters; the bit may lack them.
    pub(super) outer: Option<f64>,
    pub(super) inner: Option<f64>,
    pub(super) gauge: Option<f64>,
    pub(super) weight: Option<Value>,
    pub(super) joint: [Option<f64>; 3],
    pub(super) grade: String,
    pub(super) remarks: Vec<String>,
}

impl Row {
    /// A row of the sheet; `None` if it is empty or cannot be used.
    pub(super) fn read(cells: &mut Cells<'_>, at: usize) -> Result<Option<Self>, ImportError> {
        let numbers = [LENGTH, LENGTH_EACH, LENGTH_TOTAL, OUTER, INNER];
        if numbers.iter().all(|column| cells.text(at, *column).is_empty()) {
            return Ok(None);
        }
        let mut number = |column, range| {
            cells.number(at, column, range).map(|value: Option<Value>| value.map(Value::number))
        };
        let sequence = number(SEQUENCE, f64::MIN..=f64::MAX)?;
        let count = number(COUNT, COUNTS)?;
        let length = number(LENGTH, LENGTHS)?;
        let each = number(LENGTH_EACH, LENGTHS)?;
        let total = number(LENGTH_TOTAL, LENGTHS)?;
        let cumulative = number(CUMULATIVE, 0.0..=f64::MAX)?;
        let outer = number(OUTER, DIAMETERS)?;
        let inner = number(INNER, BORES)?;
        let gauge = number(GAUGE, DIAMETERS)?;
        let joint =
            [number(JOINT_OUTER, DIAMETERS)?, number(JOINT_INNER, BORES)?, number(JOINT_LENGTH, LENGTHS)?];
        let weight = cells.number(at, WEIGHT, MASSES)?;
        let description = cells.text(at, DESCRIPTION).split_whitespace().collect::<Vec<_>>().join(" ");
        let kinds = [cells.text(at, TYPE), cells.text(at, DESCRIPTION)];
        let found = kinds.iter().find_map(|text| kind(text));
        let kind = found.map_or(SectionKind::Collar, |(kind, _)| kind);
        let count_text = cells.text(at, COUNT);
        let is_whole = count.is_none_or(|count| count.fract() == 0.0);
        if !is_whole {
            cells.note(at, COUNT, "no whole number".to_owned());
        }
        let has_length = length.or(each).or(total).is_some();
        if !has_length {
            let column = [LENGTH_TOTAL, LENGTH_EACH, LENGTH].into_iter().rfind(|column| cells.has(*column));
            cells.require(at, column.unwrap_or(LENGTH));
        }
        let is_bit = kind == SectionKind::Bit;
        let may_lack = |column: usize| is_bit && cells.text(at, column).is_empty();
        let is_complete = [(OUTER, outer), (INNER, inner)]
            .map(|(column, value)| (column, value.is_some() || may_lack(column)));
        for (column, _) in is_complete.iter().filter(|(_, is_there)| !is_there) {
            cells.require(at, *column);
        }
        let is_hollow = inner.zip(outer).is_none_or(|(inner, outer)| inner < outer);
        if !is_hollow {
            cells.note(at, INNER, "the inner diameter is not below the outer".to_owned());
        }
        // A cell that was read is whole or noted; one that was not leaves the number of joints open.
        let has_count = count_text.is_empty() || count.is_some() && is_whole;
        if !has_length || !is_hollow || !has_count || is_complete.iter().any(|(_, is_there)| !is_there) {
            return Ok(None);
        }
        Ok(Some(Self {
            place: cells.row(at),
            at,
            description: description.chars().take(LONGEST_NAME).collect(),
            kind,
            recognised_by: found.map(|(_, words)| words),
            sequence,
            count: count.map(|count| count as u32),
            length,
            each,
            total,
            cumulative,
            outer,
            inner,
            gauge,
            weight,
            joint,
            grade: cells.text(at, GRADE).chars().take(LONGEST_NAME).collect(),
            remarks: Vec::new(),
        }))
    }

    /// Number of pieces and length of one \[m\].
    pub(super) fn pieces(&self) -> (u32, f64) {
        let count = match (self.count, self.each, self.total) {
            (Some(count), ..) => count,
            (None, Some(each), Some(total)) => ((total / each).round() as u32).max(1),
            _ => 1,
        };
        let of_total = self.total.map(|total| total / f64::from(count));
        (count, of_total.or(self.each).or(self.length).unwrap_or_default())
    }

    /// Length of the row \[m\].
    pub(super) fn whole_length(&self) -> f64 {
        let (count, length) = self.pieces();
        f64::from(count) * length
    }

    /// The row as a section, with remarks on what it lacks; `None` without diameters.
    pub(super) fn section(&mut self) -> Option<Section> {
        let (count, length) = self.pieces();
        let (outer_diameter, inner_diameter) = self.outer.zip(self.inner)?;
        if self.recognised_by.is_none() {
            self.remarks.push("the description has no known component: taken as a collar".to_owned());
        }
        if let (Some(each), Some(total)) = (self.each, self.total)
            && (each * f64::from(count) - total).abs() > ROUNDING + ROUNDING_OF_PIECE * f64::from(count)
        {
            self.remarks.push(format!("{count} pieces of {each:.2} m are not the total of {total:.2} m"));
        }
        let mass_per_length = self.weight.map(|weight| match weight {
            Value::Plain(mass) | Value::PerLength(mass) => mass,
            Value::Whole(mass) => mass / self.whole_length(),
        });
        let by_diameters =
            STEEL * FRAC_PI_4 * (outer_diameter * outer_diameter - inner_diameter * inner_diameter);
        if let Some(ratio) = mass_per_length.map(|mass| mass / by_diameters)
            && !USUAL_WEIGHTS.contains(&ratio)
        {
            self.remarks.push(format!("the weight is {ratio:.2} times that of steel of these diameters"));
        }
        let (blade_diameter, tool_joint, grade) =
            (self.blades(outer_diameter), self.tool_joint(length), self.grade());
        Some(Section {
            name: self.description.clone(),
            count,
            mass_per_length,
            blade_diameter,
            tool_joint,
            grade,
            ..Section::plain(self.kind, length, outer_diameter, inner_diameter)
        })
    }

    fn blades(&mut self, outer_diameter: f64) -> Option<f64> {
        let blades = self.gauge.filter(|gauge| *gauge >= outer_diameter + LEAST_BLADE);
        match (self.kind, blades) {
            (SectionKind::Drillpipe, Some(blades)) => {
                self.remarks.push(format!("the gauge of {blades} m is left out: drillpipe has no blades"));
                return None;
            }
            (SectionKind::Bit, None) => self.remarks.push("the bit has no gauge above its body".to_owned()),
            (SectionKind::Stabilizer, None) => {
                self.remarks.push("the stabilizer has no diameter of its blades".to_owned());
            }
            _ => {}
        }
        blades
    }

    fn tool_joint(&mut self, length: f64) -> Option<ToolJoint> {
        if self.kind != SectionKind::Drillpipe {
            return None;
        }
        let joint = match self.joint {
            [Some(outer_diameter), Some(inner_diameter), Some(of_joint)]
                if inner_diameter < outer_diameter && 2.0 * of_joint < length =>
            {
                Some(ToolJoint { length: of_joint, outer_diameter, inner_diameter, material: None })
            }
            _ => None,
        };
        if joint.is_none() {
            self.remarks.push(if self.joint.iter().any(Option::is_some) {
                "the tool joints are left out: they need a length below half of the piece's, an outer and a smaller inner diameter"
                    .to_owned()
            } else {
                "the file has no tool joints of this pipe".to_owned()
            });
        }
        joint
    }

    fn grade(&mut self) -> Option<Grade> {
        if self.grade.is_empty() {
            return None;
        }
        let plain: String = self.grade.chars().filter(char::is_ascii_alphanumeric).collect();
        let grade = match plain.to_ascii_uppercase().as_str() {
            "E75" => Some(Grade::E75),
            "X95" => Some(Grade::X95),
            "G105" => Some(Grade::G105),
            "S135" => Some(Grade::S135),
            "HWDP55" => Some(Grade::Hwdp55),
            "COLLAR110" => Some(Grade::Collar110),
            "COLLAR100" => Some(Grade::Collar100),
            _ => None,
        };
        if grade.is_none() {
            const VALID: &str = "E-75, X-95, G-105, S-135, HWDP-55, collar-110, collar-100";
            self.remarks.push(format!("the grade {} is left out: it is none of {VALID}", self.grade));
        }
        grade
    }

    pub(super) fn understood(self) -> UnderstoodComponent {
        UnderstoodComponent {
            row: self.place + 1,
            description: self.description,
            kind: self.kind,
            recognised_by: self.recognised_by,
            remarks: self.remarks,
        }
    }
}
