//! Tables of texts: CSV with any usual delimiter and encoding, and Excel.

use std::io::Cursor;

use calamine::{Data, Reader as _, Xlsx};
use thiserror::Error;

use crate::las;
use crate::rows::MOST_BYTES;

/// Largest number of rows and of columns.
const MOST_ROWS: usize = 50_000;
const MOST_COLUMNS: usize = 200;

/// Lines by which the delimiter is chosen.
const SAMPLE_LINES: usize = 60;

/// Rows of cells as texts without blanks around them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Grid {
    /// Rows; they may differ in length.
    pub rows: Vec<Vec<String>>,
    /// True if a comma is a decimal sign in it.
    pub has_decimal_comma: bool,
}

/// Reason why a file is no table.
#[derive(Debug, Error)]
pub enum GridError {
    /// The file is too large.
    #[error("the file has more than {MOST_BYTES} bytes, {MOST_ROWS} rows or {MOST_COLUMNS} columns")]
    Size,
    /// The file has no text.
    #[error("the file is empty")]
    Empty,
    /// An Excel file that cannot be read.
    #[error("the Excel file cannot be read: {0}")]
    Excel(#[from] calamine::XlsxError),
    /// The workbook has no such sheet.
    #[error("the workbook has no sheet {wanted}; it has {present}")]
    NoSheet {
        /// Requested sheet.
        wanted: String,
        /// Sheets of the workbook.
        present: String,
    },
    /// An old binary workbook.
    #[error("an Excel file before 2007 (.xls) is not read: save it as .xlsx or CSV")]
    OldExcel,
    /// Text of an unknown kind.
    #[error("the text cannot be read: {0}")]
    Text(#[from] csv::Error),
}

impl Grid {
    /// The table of a file: Excel (.xlsx), LAS 2.0, or text with commas, semicolons, tabs or blanks between its columns.
    ///
    /// # Errors
    /// The file is too large or empty, or cannot be read.
    pub fn read(bytes: &[u8], sheet: Option<&str>) -> Result<Self, GridError> {
        if bytes.len() > MOST_BYTES {
            return Err(GridError::Size);
        }
        let grid = if bytes.starts_with(b"PK\x03\x04") {
            Self::of_workbook(bytes, sheet)?
        } else if bytes.starts_with(&[0xd0, 0xcf, 0x11, 0xe0]) {
            return Err(GridError::OldExcel);
        } else {
            let text = decoded(bytes);
            match las::rows(&text) {
                Some(rows) => Self { rows, has_decimal_comma: false },
                None => Self::of_text(&text)?,
            }
        };
        if grid.rows.len() > MOST_ROWS || grid.rows.iter().any(|row| row.len() > MOST_COLUMNS) {
            return Err(GridError::Size);
        }
        if grid.rows.iter().flatten().all(String::is_empty) {
            return Err(GridError::Empty);
        }
        Ok(grid)
    }

    fn of_workbook(bytes: &[u8], sheet: Option<&str>) -> Result<Self, GridError> {
        let mut workbook: Xlsx<_> = Xlsx::new(Cursor::new(bytes))?;
        let names = workbook.sheet_names();
        let name = match sheet {
            Some(wanted) => names
                .iter()
                .find(|name| name.eq_ignore_ascii_case(wanted))
                .ok_or_else(|| GridError::NoSheet { wanted: wanted.to_owned(), present: names.join(", ") })?,
            None => names.first().ok_or(GridError::Empty)?,
        };
        let range = workbook.worksheet_range(&name.clone())?;
        let (height, width) = range.get_size();
        if height > MOST_ROWS || width > MOST_COLUMNS {
            return Err(GridError::Size);
        }
        // Rows and columns are those of the sheet, also if its first ones are empty.
        let (above, left) = range.start().map_or((0, 0), |(row, column)| (row as usize, column as usize));
        if above > MOST_ROWS || left > MOST_COLUMNS {
            return Err(GridError::Size);
        }
        let mut rows = vec![Vec::new(); above];
        for row in range.rows() {
            let cells = row.iter().map(|cell| match cell {
                Data::Empty => String::new(),
                cell => cell.to_string().trim().to_owned(),
            });
            rows.push(std::iter::repeat_n(String::new(), left).chain(cells).collect());
        }
        // Numbers of cells have a point; texts may have a comma.
        Ok(Self { rows, has_decimal_comma: false })
    }

    fn of_text(text: &str) -> Result<Self, GridError> {
        let Some(delimiter) = delimiter(text) else {
            let rows =
                text.lines().map(|line| line.split_whitespace().map(str::to_owned).collect()).collect();
            return Ok(Self { has_decimal_comma: !text.contains('.'), rows });
        };
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let mut rows: Vec<Vec<String>> = Vec::new();
        let (mut line, mut counted) = (0, 0);
        for record in reader.records() {
            let record = record?;
            // Empty lines are no records, and stand before the next one; rows are the lines of the file.
            let before = record.position().map_or(counted, |position| position.byte() as usize);
            let empty =
                text.as_bytes()[before..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
            line += text.as_bytes()[counted..before + empty].iter().filter(|byte| **byte == b'\n').count();
            counted = before + empty;
            if line >= MOST_ROWS {
                return Err(GridError::Size);
            }
            rows.resize(rows.len().max(line), Vec::new());
            rows.push(record.iter().map(str::to_owned).collect());
        }
        Ok(Self { rows, has_decimal_comma: delimiter != b',' && has_decimal_comma(text) })
    }
}

/// Text of bytes in UTF-8, UTF-16 with a byte order mark, or else Latin-1, which files of older programs have for degrees.
fn decoded(bytes: &[u8]) -> String {
    let utf16 = |pairs: &[u8], of: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = pairs.chunks_exact(2).map(|pair| of([pair[0], pair[1]])).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => String::from_utf8_lossy(rest).into_owned(),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => bytes.iter().copied().map(char::from).collect(),
        },
    }
}

/// The delimiter that divides most lines into columns; `None` if blanks do.
fn delimiter(text: &str) -> Option<u8> {
    let lines = || text.lines().filter(|line| !line.trim().is_empty()).take(SAMPLE_LINES);
    let divided = |delimiter: char| lines().filter(|line| line.matches(delimiter).count() >= 2).count();
    // A semicolon or tab is never part of a number; a comma may be its decimal sign.
    let counts = [('\t', divided('\t')), (';', divided(';')), (',', divided(','))];
    let (delimiter, most) = counts.into_iter().max_by_key(|(_, count)| *count)?;
    (2 * most > lines().count()).then_some(delimiter as u8)
}

/// True if commas stand within numbers, and no points do.
fn has_decimal_comma(text: &str) -> bool {
    let between_digits = |sign: char| {
        text.match_indices(sign).take(1000).any(|(at, _)| {
            let is_digit = |sign: Option<char>| sign.is_some_and(|sign| sign.is_ascii_digit());
            is_digit(text[..at].chars().next_back()) && is_digit(text[at + 1..].chars().next())
        })
    };
    between_digits(',') && !between_digits('.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delimiters_and_decimal_signs_are_recognised() {
        for (text, cells, comma) in [
            ("MD,INC,AZI\n0,0,0\n10.5,1,2\n", ["10.5", "1", "2"], false),
            ("MD;INC;AZI\n0;0;0\n10,5;1;2\n", ["10,5", "1", "2"], true),
            ("MD\tINC\tAZI\n0\t0\t0\n10.5\t1\t2\n", ["10.5", "1", "2"], false),
            ("MD INC AZI\n0 0 0\n10.5 1 2\n", ["10.5", "1", "2"], false),
        ] {
            let grid = Grid::read(text.as_bytes(), None).unwrap();
            assert_eq!(
                (grid.rows[2].as_slice(), grid.has_decimal_comma),
                (&cells.map(str::to_owned)[..], comma)
            );
        }
    }

    #[test]
    fn rows_are_lines_of_the_file_and_quotes_hold_delimiters() {
        let grid = Grid::read(b"Well,\"A, B\",1\n\n\nMD,INC,AZI\n", None).unwrap();
        assert_eq!(grid.rows[0][1], "A, B");
        assert_eq!(grid.rows[3], ["MD", "INC", "AZI"]);
    }

    #[test]
    fn latin_1_and_utf_16_are_read() {
        assert_eq!(decoded(b"Inc (\xb0)"), "Inc (\u{b0})");
        let utf16: Vec<u8> =
            [0xff, 0xfe].into_iter().chain("MD".encode_utf16().flat_map(u16::to_le_bytes)).collect();
        assert_eq!(decoded(&utf16), "MD");
    }

    #[test]
    fn hostile_files_are_refused_or_read_within_bounds() {
        assert!(matches!(Grid::read(&vec![b'1'; MOST_BYTES + 1], None), Err(GridError::Size)));
        assert!(matches!(Grid::read(b" \n \n", None), Err(GridError::Empty)));
        assert!(matches!(Grid::read("1,2,3\n".repeat(MOST_ROWS + 1).as_bytes(), None), Err(GridError::Size)));
        assert!(matches!(Grid::read(&vec![b','; 1000], None), Err(GridError::Size | GridError::Empty)));
        assert!(matches!(Grid::read(b"PK\x03\x04nonsense", None), Err(GridError::Excel(_))));
        assert!(matches!(Grid::read(&[0xd0, 0xcf, 0x11, 0xe0, 0], None), Err(GridError::OldExcel)));
    }
}
