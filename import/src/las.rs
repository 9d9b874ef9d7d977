//! Log ASCII Standard 2.0 (Canadian Well Logging Society, 1992): curves with units in `~C`, numbers in `~A`.

/// True if a text is a LAS file: its first line that is no comment begins the section of the version.
pub(crate) fn is_las(text: &str) -> bool {
    let first = text.lines().find(|line| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    first.is_some_and(|line| is_section(line, 'V'))
}

fn is_section(line: &str, letter: char) -> bool {
    let mut signs = line.trim_start().chars();
    signs.next() == Some('~') && signs.next().is_some_and(|sign| sign.eq_ignore_ascii_case(&letter))
}

/// Rows of cells of a LAS file: a row of curves with their units above the data, at the rows that they have in the file.
pub(crate) fn rows(text: &str) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let mut curves = Vec::new();
    let (mut in_curves, mut in_data) = (false, false);
    for line in text.lines() {
        let mut row = Vec::new();
        if line.trim_start().starts_with('~') {
            (in_curves, in_data) = (is_section(line, 'C'), is_section(line, 'A'));
            if in_data {
                row.clone_from(&curves);
            }
        } else if !line.trim_start().starts_with('#') {
            if in_curves {
                curves.extend(curve(line));
            } else if in_data {
                row = line.split_whitespace().map(str::to_owned).collect();
            }
        }
        rows.push(row);
    }
    rows
}

/// Heading of a curve: `DEPT.M : depth` is `DEPT (M)`.
fn curve(line: &str) -> Option<String> {
    let (mnemonic, rest) = line.split_once('.')?;
    let unit = rest.split([' ', ':']).next().unwrap_or_default();
    let mnemonic = mnemonic.trim();
    (!mnemonic.is_empty())
        .then(|| if unit.is_empty() { mnemonic.to_owned() } else { format!("{mnemonic} ({unit})") })
}
