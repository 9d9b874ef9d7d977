//! Text for people: columns, numbers, and no control characters.

use std::borrow::Cow;
use std::fmt::{Display, Write as _};

use drillsweep_quantity::{Quantity, Unit, UnitChoice};

/// Alignment of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Alignment {
    Left,
    Right,
}

/// Rows under a header, columns as wide as their widest text; nothing trails a line.
pub(crate) fn columns(
    header: &[&str],
    rows: &[Vec<String>],
    alignment: impl Fn(usize) -> Alignment,
) -> String {
    // A line end within a cell would begin a row of its own.
    let in_line = |text: &String| text.replace('\n', "\\u000a").replace('\t', "\\u0009");
    let rows: Vec<Vec<String>> = rows.iter().map(|row| row.iter().map(in_line).collect()).collect();
    let width = |column: usize| {
        let texts = rows.iter().filter_map(|row| row.get(column)).map(String::as_str);
        texts.chain([header[column]]).map(|text| text.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |texts: &mut dyn Iterator<Item = &str>| {
        let cells: Vec<String> = texts
            .zip(&widths)
            .enumerate()
            .map(|(column, (text, &width))| match alignment(column) {
                Alignment::Left => format!("{text:width$}"),
                Alignment::Right => format!("{text:>width$}"),
            })
            .collect();
        cells.join("  ").trim_end().to_owned()
    };
    let mut lines = vec![line(&mut header.iter().copied())];
    lines.extend(rows.iter().map(|row| line(&mut row.iter().map(String::as_str))));
    lines.join("\n")
}

/// Error with its causes, each once: many errors report their cause themselves.
pub(crate) fn chain(error: &anyhow::Error) -> String {
    let mut told = error.to_string();
    for cause in error.chain().skip(1) {
        let cause = cause.to_string();
        if !told.contains(&cause) {
            let _ = write!(told, ": {cause}");
        }
    }
    told
}

/// Number with its noun, whose plural has an s.
pub(crate) fn count(number: impl Display, of: &str) -> String {
    let number = number.to_string();
    let plural = if number == "1" { "" } else { "s" };
    format!("{number} {of}{plural}")
}

/// Text with its control characters, except line ends and tabs, as `\u001b`, which a terminal shows and JSON reads as the same
/// character: names and messages of others are printed, and must not move the cursor, rename the window, break lines or reverse
/// the text next to them.
pub(crate) fn visible(text: &str) -> Cow<'_, str> {
    let is_obeyed = |character: char| match character {
        '\n' | '\t' => false,
        // Separators of lines and paragraphs, and what changes the direction of writing (Unicode Standard Annex 9, section 2).
        '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
        _ => character.is_control(),
    };
    if !text.contains(is_obeyed) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        if is_obeyed(character) {
            let _ = write!(shown, "\\u{:04x}", u32::from(character));
        } else {
            shown.push(character);
        }
    }
    Cow::Owned(shown)
}

/// Unit of a text's numbers, with their decimals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shown {
    unit: Unit,
    decimals: usize,
}

impl Shown {
    /// The unit in which a reader's choice shows a quantity, SI with prefixes without one. Its decimals keep differences of `resolution`, in the unit in
    /// which the quantity is kept.
    pub(crate) fn new(choice: &UnitChoice, quantity: &Quantity, resolution: f64) -> Self {
        let unit = choice.shown(quantity.name).unwrap_or(Unit { symbol: "", size: 1.0 });
        // Rounding of a power of ten adds no decimal.
        let decimals = ((unit.size / resolution).log10() - 1e-9).ceil().max(0.0) as usize;
        Self { unit, decimals }
    }

    /// A value without its unit.
    pub(crate) fn number(&self, value: f64) -> String {
        format!("{:.*}", self.decimals, self.unit.of(value))
    }

    /// A value with its unit.
    pub(crate) fn with_unit(&self, value: f64) -> String {
        format!("{} {}", self.number(value), self.unit.symbol)
    }

    /// Symbol of the unit.
    pub(crate) fn symbol(&self) -> &'static str {
        self.unit.symbol
    }
}

/// A number to six significant digits, as short as it can be; whole numbers in full.
pub(crate) fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if value.fract() == 0.0 && value.abs() < 1e15 {
        format!("{value}")
    } else if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_and_not_obeyed() {
        assert_eq!(visible("a\tb\né"), "a\tb\né");
        let hostile = "\u{1b}]0;owned\u{7}\u{9b}2J";
        assert_eq!(visible(hostile), "\\u001b]0;owned\\u0007\\u009b2J");
        assert_eq!(visible("a\u{202e}b\u{2028}c"), "a\\u202eb\\u2028c");
        let json = serde_json::to_string(hostile).unwrap();
        assert_eq!(serde_json::from_str::<String>(&visible(&json)).unwrap(), hostile);
    }

    #[test]
    fn a_cell_stays_in_its_row() {
        let table =
            columns(&["name", "state"], &[vec!["a\nb".to_owned(), "x".to_owned()]], |_| Alignment::Left);
        assert_eq!(table.lines().collect::<Vec<_>>(), ["name      state", "a\\u000ab  x"]);
    }

    #[test]
    fn a_cause_is_printed_once() {
        let denied = || std::io::Error::from(std::io::ErrorKind::PermissionDenied);
        let error = drillsweep_store::StoreError::Directory { path: "data".to_owned(), source: denied() };
        assert_eq!(chain(&error.into()), "data: permission denied");
        assert_eq!(chain(&anyhow::Error::from(denied()).context("no sweep")), "no sweep: permission denied");
        assert_eq!((count(1, "point"), count(12, "point")), ("1 point".to_owned(), "12 points".to_owned()));
    }

    #[test]
    fn numbers_have_six_digits() {
        let numbers =
            [0.1 + 0.2, 1.0 / 3.0, 1234567.0, -0.04, 0.0, 2.5e-9 / 3.0, 123456.78, 2.03e11 / 3.0, 600.0];
        let texts: Vec<_> = numbers.into_iter().map(number).collect();
        assert_eq!(
            texts,
            ["0.3", "0.333333", "1234567", "-0.04", "0", "8.33333e-10", "123457", "6.76667e10", "600"]
        );
    }

    #[test]
    fn shown_numbers_keep_differences_in_any_unit() {
        use drillsweep_quantity::columns::{HOOK_LOAD, SURFACE_TORQUE};
        let load = |units: &str| Shown::new(&UnitChoice::parse(units).unwrap(), &HOOK_LOAD, 100.0);
        assert_eq!(load("si").with_unit(51_723.0), "51.7 kN");
        // Steps of 44 N; one decimal would have steps of 445 N.
        assert_eq!(load("field").with_unit(51_723.0), "11.63 klbf");
        assert_eq!(load("field,hook_load:N").with_unit(51_723.0), "51723 N");
        let usual = Shown::new(&UnitChoice::default(), &SURFACE_TORQUE, 10.0);
        assert_eq!((usual.number(-1_480.0).as_str(), usual.symbol()), ("-1.48", "kN m"));
    }

    #[test]
    fn columns_are_as_wide_as_their_widest_text() {
        let rows = [
            vec!["a".to_owned(), "10".to_owned(), String::new()],
            vec!["bcd".to_owned(), "9".to_owned(), "x".to_owned()],
        ];
        let table = columns(&["n", "v", "w"], &rows, |column| match column {
            1 => Alignment::Right,
            _ => Alignment::Left,
        });
        assert_eq!(table, "n     v  w\na    10\nbcd   9  x");
    }
}
