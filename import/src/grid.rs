//! Tables of texts: CSV with any usual delimiter and encoding, and Excel.

use std::io::{self, Cursor, Read as _};

use calamine::{DataRef, Reader as _, Xlsx};
use thiserror::Error;
use zip::ZipArchive;

use crate::las;
use crate::rows::MOST_BYTES;

/// Largest number of rows and of columns.
const MOST_ROWS: usize = 50_000;
const MOST_COLUMNS: usize = 200;

/// Largest number of cells, and of bytes of their texts together.
const MOST_CELLS: usize = 1_000_000;
const MOST_TEXT: usize = 2 * MOST_BYTES;

/// Largest size of a workbook's files together, uncompressed \[bytes\].
const MOST_INFLATED: u64 = 32 << 20;

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
    #[error(
        "the file has more than {MOST_BYTES} bytes ({MOST_INFLATED} uncompressed), {MOST_ROWS} rows, {MOST_COLUMNS} columns or {MOST_CELLS} cells"
    )]
    Size,
    /// The file has no text.
    #[error("the file is empty")]
    Empty,
    /// An Excel file that cannot be read.
    #[error("the Excel file cannot be read: {0}")]
    Excel(#[from] calamine::XlsxError),
    /// A workbook whose archive cannot be read.
    #[error("the Excel file cannot be read: {0}")]
    Archive(#[from] zip::result::ZipError),
    /// A file of a workbook that cannot be uncompressed.
    #[error("the Excel file cannot be read: {0}")]
    Inflate(#[from] io::Error),
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
            if !las::is_las(&text) {
                Self::of_text(&text)?
            } else if text.split_whitespace().nth(MOST_CELLS).is_some() {
                return Err(GridError::Size);
            } else {
                Self { rows: las::rows(&text), has_decimal_comma: false }
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
        require_small_archive(bytes)?;
        let mut workbook: Xlsx<_> = Xlsx::new(Cursor::new(bytes))?;
        let names = workbook.sheet_names();
        let name = match sheet {
            Some(wanted) => names
                .iter()
                .find(|name| name.eq_ignore_ascii_case(wanted))
                .ok_or_else(|| GridError::NoSheet { wanted: wanted.to_owned(), present: names.join(", ") })?,
            None => names.first().ok_or(GridError::Empty)?,
        };
        // Cell by cell: a range would have all cells between the first and the last one.
        let mut cells = workbook.worksheet_cells_reader(name)?;
        let mut rows: Vec<Vec<String>> = Vec::new();
        let mut budget = Budget::default();
        while let Some(cell) = cells.next_cell()? {
            let text = match cell.get_value() {
                DataRef::Empty => continue,
                DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
                    text.trim().to_owned()
                }
                DataRef::SharedString(text) => text.trim().to_owned(),
                DataRef::Int(value) => value.to_string(),
                DataRef::Float(value) => value.to_string(),
                DataRef::Bool(value) => value.to_string(),
                DataRef::DateTime(value) => value.as_f64().to_string(),
                DataRef::Error(error) => error.to_string(),
            };
            let (row, column) = cell.get_position();
            let (row, column) = (row as usize, column as usize);
            if row >= MOST_ROWS || column >= MOST_COLUMNS {
                return Err(GridError::Size);
            }
            rows.resize(rows.len().max(row + 1), Vec::new());
            let before = rows[row].len();
            budget.take((column + 1).saturating_sub(before), text.len())?;
            rows[row].resize(before.max(column + 1), String::new());
            rows[row][column] = text;
        }
        // Numbers of cells have a point; texts may have a comma.
        Ok(Self { rows, has_decimal_comma: false })
    }

    fn of_text(text: &str) -> Result<Self, GridError> {
        let Some(delimiter) = delimiter(text) else {
            let mut budget = Budget::default();
            let row = |line: &str| {
                let cells: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
                budget.take(cells.len(), line.len()).map(|()| cells)
            };
            let rows = text.lines().take(MOST_ROWS + 1).map(row).collect::<Result<Vec<_>, _>>()?;
            return Ok(Self { has_decimal_comma: has_decimal_comma(&rows), rows });
        };
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let mut rows: Vec<Vec<String>> = Vec::new();
        let mut budget = Budget::default();
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
            budget.take(record.len(), record.as_slice().len())?;
            rows.resize(rows.len().max(line), Vec::new());
            rows.push(record.iter().map(str::to_owned).collect());
        }
        Ok(Self { has_decimal_comma: delimiter != b',' && has_decimal_comma(&rows), rows })
    }
}

/// Cells and bytes of their texts that may still follow.
struct Budget {
    cells: usize,
    bytes: usize,
}

impl Default for Budget {
    fn default() -> Self {
        Self { cells: MOST_CELLS, bytes: MOST_TEXT }
    }
}

impl Budget {
    fn take(&mut self, cells: usize, bytes: usize) -> Result<(), GridError> {
        self.cells = self.cells.checked_sub(cells).ok_or(GridError::Size)?;
        self.bytes = self.bytes.checked_sub(bytes).ok_or(GridError::Size)?;
        Ok(())
    }
}

/// Refuses an archive whose files are large uncompressed, before any of them is held in memory; their headers may state less.
fn require_small_archive(bytes: &[u8]) -> Result<(), GridError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes))?;
    let mut left = MOST_INFLATED;
    for index in 0..archive.len() {
        let size = io::copy(&mut archive.by_index(index)?.take(left + 1), &mut io::sink())?;
        left = left.checked_sub(size).ok_or(GridError::Size)?;
    }
    Ok(())
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
    let divided = |delimiter: char, least: usize| {
        lines().filter(|line| line.matches(delimiter).count() >= least).count()
    };
    // A semicolon or tab is never part of a number; a comma may be its decimal sign, but not in headings. Of equal numbers the last counts.
    let headings = lines().find(|line| line.contains(char::is_alphabetic));
    let least = if headings.is_some_and(|line| line.contains(',')) { 1 } else { 2 };
    let counts = [(',', divided(',', least)), ('\t', divided('\t', 1)), (';', divided(';', 1))];
    let (delimiter, most) = counts.into_iter().max_by_key(|(_, count)| *count)?;
    (2 * most > lines().count()).then_some(delimiter as u8)
}

/// True if the last sign of numbers is a comma, and of none a point; texts between them, such as dates, do not count.
fn has_decimal_comma(rows: &[Vec<String>]) -> bool {
    let is_number = |cell: &&String| {
        cell.bytes().all(|byte| byte.is_ascii_digit() || matches!(byte, b',' | b'.' | b'-' | b'+' | b' '))
            && (cell.contains(',') || cell.matches('.').count() <= 1)
    };
    let numbers = rows.iter().flatten().filter(is_number);
    let signs = numbers.filter_map(|cell| cell.rfind([',', '.']).map(|at| cell.as_bytes()[at]));
    let mut signs = signs.take(1000).peekable();
    signs.peek().is_some() && signs.all(|sign| sign == b',')
}

#[cfg(test)]
pub(crate) mod tests {
    use std::fmt::Write as _;
    use std::io::Write as _;

    use zip::ZipWriter;
    use zip::write::SimpleFileOptions;

    use super::*;

    /// A workbook of sheets with rows of texts, or numbers if they are some.
    pub(crate) fn workbook(sheets: &[(&str, &[&[&str]])]) -> Vec<u8> {
        let (mut list, mut relations) = (String::new(), String::new());
        let mut files = Vec::new();
        for (at, (name, rows)) in sheets.iter().enumerate() {
            write!(list, "<sheet name=\"{name}\" sheetId=\"{0}\" r:id=\"r{0}\"/>", at + 1).unwrap();
            write!(relations, "<Relationship Id=\"r{0}\" Type=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet\" Target=\"worksheets/sheet{0}.xml\"/>", at + 1).unwrap();
            let mut data = String::new();
            for (row, cells) in rows.iter().enumerate() {
                write!(data, "<row r=\"{}\">", row + 1).unwrap();
                for (column, text) in cells.iter().enumerate().filter(|(_, text)| !text.is_empty()) {
                    let place = format!("{}{}", crate::rows::column_name(column), row + 1);
                    match text.parse::<f64>() {
                        Ok(value) => write!(data, "<c r=\"{place}\"><v>{value}</v></c>").unwrap(),
                        Err(_) => {
                            write!(data, "<c r=\"{place}\" t=\"inlineStr\"><is><t>{text}</t></is></c>")
                                .unwrap();
                        }
                    }
                }
                data += "</row>";
            }
            files.push((format!("xl/worksheets/sheet{}.xml", at + 1), format!("<worksheet xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\"><sheetData>{data}</sheetData></worksheet>")));
        }
        files.push(("xl/workbook.xml".to_owned(), format!("<workbook xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\" xmlns:r=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships\"><sheets>{list}</sheets></workbook>")));
        files.push(("xl/_rels/workbook.xml.rels".to_owned(), format!("<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">{relations}</Relationships>")));
        archive(&files)
    }

    fn archive(files: &[(String, String)]) -> Vec<u8> {
        let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, text) in files {
            writer.start_file(name.as_str(), SimpleFileOptions::default()).unwrap();
            writer.write_all(text.as_bytes()).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    #[test]
    fn workbooks_that_grow_are_refused_before_they_are_held() {
        let inflated = archive(&[("xl/workbook.xml".to_owned(), " ".repeat(MOST_INFLATED as usize + 1))]);
        assert!(inflated.len() < MOST_BYTES);
        assert!(matches!(Grid::read(&inflated, None), Err(GridError::Size)));
        // Two cells in the corners of a sheet have 17 thousand million cells between them.
        let corners = "<worksheet xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\"><sheetData><row r=\"1\"><c r=\"A1\"><v>1</v></c></row><row r=\"1048576\"><c r=\"XFD1048576\"><v>1</v></c></row></sheetData></worksheet>";
        let mut files: Vec<(String, String)> = Vec::new();
        let bytes = workbook(&[("Sheet", &[&["text"]])]);
        let mut archived = ZipArchive::new(Cursor::new(&bytes)).unwrap();
        for at in 0..archived.len() {
            let mut file = archived.by_index(at).unwrap();
            let (name, mut text) = (file.name().unwrap().into_owned(), String::new());
            file.read_to_string(&mut text).unwrap();
            let is_sheet = name.starts_with("xl/worksheets");
            files.push((name, if is_sheet { corners.to_owned() } else { text }));
        }
        assert!(matches!(Grid::read(&archive(&files), None), Err(GridError::Size)));
    }

    #[test]
    fn delimiters_and_decimal_signs_are_recognised() {
        for (text, cells, comma) in [
            ("MD,INC,AZI\n0,0,0\n10.5,1,2\n", ["10.5", "1", "2"], false),
            ("MD;INC;AZI\n0;0;0\n10,5;1;2\n", ["10,5", "1", "2"], true),
            ("MD\tINC\tAZI\n0\t0\t0\n10.5\t1\t2\n", ["10.5", "1", "2"], false),
            ("MD INC AZI\n0 0 0\n10.5 1 2\n", ["10.5", "1", "2"], false),
            ("MD;INC;AZI\n3.4.2020;of 9.5 in;0\n1.010,5;1;2\n", ["1.010,5", "1", "2"], true),
            ("MD;INC;AZI\n0;0;0\n1,010.5;1,5;2\n", ["1,010.5", "1,5", "2"], false),
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
        assert!(matches!(Grid::read(b"PK\x03\x04nonsense", None), Err(GridError::Archive(_))));
        let wide = format!("{}\n", "a ".repeat(MOST_COLUMNS - 1)).repeat(MOST_CELLS / (MOST_COLUMNS - 1) + 1);
        assert!(matches!(Grid::read(wide.as_bytes(), None), Err(GridError::Size)));
        assert!(matches!(Grid::read(&[0xd0, 0xcf, 0x11, 0xe0, 0], None), Err(GridError::OldExcel)));
    }
}
