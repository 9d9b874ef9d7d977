//! Rows of a table or of a WITSML object, with the columns of their quantities.

use std::ops::RangeInclusive;

use crate::error::ImportError;
use crate::grid::Grid;
use crate::headings::{Found, Sought, find};
use crate::measure::{AssumedUnits, Dimension, Fault, Measures, Value};
use crate::rows::{CellProblem, MOST_PROBLEMS, UnderstoodColumn};
use crate::witsml::{self, Path};

/// A column of a table, and the elements of WITSML that stand for it.
pub(crate) struct Column {
    pub(crate) sought: Sought,
    pub(crate) elements: Path,
    /// Dimension of its numbers; `None` for texts.
    pub(crate) dimension: Option<Dimension>,
}

impl Column {
    pub(crate) const fn required(
        quantity: &'static str,
        dimension: Option<Dimension>,
        headings: &'static [&'static str],
        elements: Path,
    ) -> Self {
        Self { sought: Sought { quantity, headings, is_required: true }, elements, dimension }
    }

    pub(crate) const fn optional(
        quantity: &'static str,
        dimension: Option<Dimension>,
        headings: &'static [&'static str],
        elements: Path,
    ) -> Self {
        Self { sought: Sought { quantity, headings, is_required: false }, elements, dimension }
    }
}

/// Columns of a table, and names of the WITSML object and of its rows.
pub(crate) struct Layout {
    pub(crate) columns: &'static [Column],
    /// Required headings, in words.
    pub(crate) wanted: &'static str,
    pub(crate) elements: [&'static str; 2],
}

/// Rows of a file with the columns of a layout.
pub(crate) struct Sheet {
    columns: Vec<Option<Found>>,
    /// Rows from 0 (lines of a WITSML file), with the cells of the columns; empty texts for missing ones.
    rows: Vec<(usize, Vec<String>)>,
    has_decimal_comma: bool,
}

impl Sheet {
    /// Rows of a file: CSV, Excel or WITSML. `name` is that of the sheet, or of the WITSML object.
    pub(crate) fn read(bytes: &[u8], name: Option<&str>, layout: &Layout) -> Result<Self, ImportError> {
        if witsml::is_xml(bytes) {
            return Self::of_witsml(bytes, name, layout);
        }
        let grid = Grid::read(bytes, name)?;
        let sought: Vec<&Sought> = layout.columns.iter().map(|column| &column.sought).collect();
        let (columns, first) = find(&grid, &sought).ok_or(ImportError::NoHeadings(layout.wanted))?;
        let cells = |row: &Vec<String>| {
            let cell = |found: &Option<Found>| found.as_ref().and_then(|found| row.get(found.column));
            columns.iter().map(|found| cell(found).cloned().unwrap_or_default()).collect()
        };
        let rows = grid.rows.iter().enumerate().skip(first).map(|(row, texts)| (row, cells(texts))).collect();
        Ok(Self { columns, rows, has_decimal_comma: grid.has_decimal_comma })
    }

    fn of_witsml(bytes: &[u8], name: Option<&str>, layout: &Layout) -> Result<Self, ImportError> {
        const MOST_NAMES: usize = 20;
        let paths: Vec<Path> = layout.columns.iter().map(|column| column.elements).collect();
        let mut tables = witsml::tables(bytes, layout.elements, &paths)?;
        let names: Vec<String> = tables.iter().map(|table| table.name.clone()).take(MOST_NAMES).collect();
        let at = match name {
            Some(name) => tables.iter().position(|table| table.name.eq_ignore_ascii_case(name)),
            None => (tables.len() == 1).then_some(0),
        };
        let at = at.ok_or_else(|| ImportError::Open {
            option: "sheet",
            open: format!("the file has {} of the element `{}`", tables.len(), layout.elements[0]),
            valid: format!("one of {}", names.join(", ")),
        })?;
        let table = tables.swap_remove(at);
        Ok(Self { columns: table.columns, rows: table.rows, has_decimal_comma: false })
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }
}

/// Cells of a sheet as numbers, with the problems of those that have none.
pub(crate) struct Cells<'a> {
    sheet: &'a Sheet,
    layout: &'a Layout,
    measures: Vec<Option<Measures<'a>>>,
    pub(crate) problems: Vec<CellProblem>,
}

impl<'a> Cells<'a> {
    /// Cells of a sheet.
    ///
    /// # Errors
    /// The unit of a heading does not fit.
    pub(crate) fn new(
        sheet: &'a Sheet,
        layout: &'a Layout,
        assumed: Option<AssumedUnits>,
    ) -> Result<Self, ImportError> {
        let measures = sheet.columns.iter().zip(layout.columns).map(|(found, column)| {
            let found = found.as_ref().zip(column.dimension);
            found
                .map(|(found, dimension)| Measures::new(found, column.sought.quantity, dimension, assumed))
                .transpose()
        });
        Ok(Self { sheet, layout, measures: measures.collect::<Result<_, _>>()?, problems: Vec::new() })
    }

    /// Row in the file, from 0, of a row of the sheet.
    pub(crate) fn row(&self, at: usize) -> usize {
        self.sheet.rows[at].0
    }

    /// Text of a cell; empty if the file lacks the column.
    pub(crate) fn text(&self, at: usize, column: usize) -> &'a str {
        &self.sheet.rows[at].1[column]
    }

    /// True if the file has the column.
    pub(crate) fn has(&self, column: usize) -> bool {
        self.sheet.columns[column].is_some()
    }

    /// Heading of a column; empty if the file lacks it.
    pub(crate) fn heading(&self, column: usize) -> &'a str {
        self.sheet.columns[column].as_ref().map_or("", |found| &found.heading)
    }

    /// The value of a cell in a range; `None` if it is empty, or has a problem, which is noted.
    ///
    /// # Errors
    /// The column has no unit.
    pub(crate) fn number(
        &mut self,
        at: usize,
        column: usize,
        range: RangeInclusive<f64>,
    ) -> Result<Option<Value>, ImportError> {
        let text = self.text(at, column);
        let Some(measures) = self.measures[column].as_mut().filter(|_| !text.is_empty()) else {
            return Ok(None);
        };
        let fault = match measures.read(text, self.sheet.has_decimal_comma) {
            Ok(value) if range.contains(&value.number()) => return Ok(Some(value)),
            Ok(value) => {
                let (least, most) = range.into_inner();
                format!("{} in SI units is not between {least} and {most}", value.number())
            }
            Err(Fault::Cell(fault)) => fault,
            Err(Fault::NoUnit) => return Err(measures.no_unit()),
        };
        self.note(at, column, fault);
        Ok(None)
    }

    /// Notes that a cell has no value, unless its problem is noted already.
    pub(crate) fn require(&mut self, at: usize, column: usize) {
        if self.text(at, column).is_empty() {
            self.note(at, column, "the cell is empty".to_owned());
        }
    }

    /// Notes a problem of a cell.
    pub(crate) fn note(&mut self, at: usize, column: usize, problem: String) {
        let name = self.sheet.columns[column].as_ref().map(|found| found.name.as_str());
        self.problems.push(CellProblem::new(self.row(at), name, self.text(at, column), problem));
    }

    /// True if as many problems are noted as are reported.
    pub(crate) fn is_full(&self) -> bool {
        self.problems.len() >= MOST_PROBLEMS
    }

    /// Meanings of the columns that were read, and the problems in the order of the file.
    pub(crate) fn understood(self) -> (Vec<UnderstoodColumn>, Vec<CellProblem>) {
        let text = |found: &Found, column: &Column| UnderstoodColumn {
            quantity: column.sought.quantity,
            column: found.name.clone(),
            heading: found.heading.clone(),
            unit: String::new(),
            is_assumed: false,
        };
        let columns = self.sheet.columns.iter().zip(self.layout.columns).zip(self.measures);
        let columns = columns.filter_map(|((found, column), measures)| match measures {
            Some(measures) => measures.understood(),
            None => found.as_ref().map(|found| text(found, column)),
        });
        let columns = columns.collect();
        let mut problems = self.problems;
        problems.sort_by_key(|problem| problem.row);
        (columns, problems)
    }
}
