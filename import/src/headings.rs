//! Headings of columns with their units.

use crate::grid::Grid;

/// A quantity whose column is sought.
pub(crate) struct Sought {
    /// Its name.
    pub(crate) quantity: &'static str,
    /// Headings that mean it, without blanks, signs and units, in lower case.
    pub(crate) headings: &'static [&'static str],
}

/// A column that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Found {
    /// Place of the column, from 0.
    pub(crate) column: usize,
    pub(crate) heading: String,
    /// Unit in the heading, or in the row below; absent if neither has one.
    pub(crate) unit: Option<String>,
}

/// Rows in which headings are sought.
const HEAD_ROWS: usize = 200;

/// The row of headings, from 0, the first row of numbers below it, and the column of each quantity; `None` if no row has them all.
pub(crate) fn find(grid: &Grid, sought: &[Sought]) -> Option<(usize, usize, Vec<Found>)> {
    grid.rows.iter().take(HEAD_ROWS).enumerate().find_map(|(row, cells)| {
        let column_of = |sought: &Sought| {
            let is_it = |cell: &&String| sought.headings.contains(&parts(cell).0.as_str());
            let heading = cells.iter().find(is_it)?;
            let column = cells.iter().position(|cell| std::ptr::eq(cell, heading))?;
            Some(Found { column, heading: heading.clone(), unit: parts(heading).1 })
        };
        let mut found: Vec<Found> = sought.iter().map(column_of).collect::<Option<_>>()?;
        // A row of units below the headings.
        let below = grid.rows.get(row + 1);
        let cell = |column: usize| below.and_then(|cells| cells.get(column)).map_or("", String::as_str);
        let has_units = found.iter().any(|found| !cell(found.column).is_empty())
            && found.iter().all(|found| !cell(found.column).contains(|sign: char| sign.is_ascii_digit()));
        if has_units {
            for found in &mut found {
                let unit = cell(found.column).trim_matches(['(', ')', '[', ']']).trim();
                found.unit = found.unit.take().or_else(|| (!unit.is_empty()).then(|| unit.to_owned()));
            }
        }
        Some((row, row + 1 + usize::from(has_units), found))
    })
}

/// Name and unit of a heading: `Meas. Depth (ft)`, `MD[m]`, `Inc, deg`, `Incl °`.
fn parts(heading: &str) -> (String, Option<String>) {
    let (name, unit) = match heading.split_once(['(', '[', '<', '{', ',', ';']) {
        Some((name, unit)) => (name, unit.trim_matches([')', ']', '>', '}', ' '])),
        None => match heading.strip_suffix('°') {
            Some(name) => (name, "°"),
            // `MD_ft`, `MD ft`, `MD m`
            None => match heading.trim().rsplit_once(['_', ' ']) {
                Some((name, unit @ ("m" | "M" | "ft" | "FT" | "Ft" | "deg" | "DEG" | "Deg" | "dega"))) => {
                    (name, unit)
                }
                _ => (heading, ""),
            },
        },
    };
    let name = name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase();
    (name, (!unit.is_empty()).then(|| unit.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_have_names_and_units() {
        for (heading, name, unit) in [
            ("Measured Depth (ft)", "measureddepth", Some("ft")),
            ("MD[m]", "md", Some("m")),
            ("Incl. °", "incl", Some("°")),
            ("INC, deg", "inc", Some("deg")),
            ("MD_ft", "md", Some("ft")),
            ("Azimuth", "azimuth", None),
            ("DEPT (M)", "dept", Some("M")),
        ] {
            assert_eq!(parts(heading), (name.to_owned(), unit.map(str::to_owned)), "{heading}");
        }
    }
}
