//! Columns of text for people.

/// To which side a column's texts go.
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

#[cfg(test)]
mod tests {
    use super::*;

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
