//! Headings of columns with their units.

use crate::grid::Grid;
use crate::rows::column_name;

/// A quantity whose column is sought.
pub(crate) struct Sought {
    /// Its name.
    pub(crate) quantity: &'static str,
    /// Headings that mean it, without blanks, signs and units, in lower case; the first ones are preferred.
    pub(crate) headings: &'static [&'static str],
    /// True if no file goes without it.
    pub(crate) is_required: bool,
}

/// A column that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Found {
    /// Place of the column, from 0.
    pub(crate) column: usize,
    /// Its name as spreadsheets have it, or the element of a WITSML file.
    pub(crate) name: String,
    pub(crate) heading: String,
    /// Unit in the heading, or in the row below; absent if neither has one.
    pub(crate) unit: Option<String>,
}

/// Rows in which headings are sought.
const HEAD_ROWS: usize = 200;

/// Columns of the quantities that are sought, `None` for an optional one that is missing, and the first row below their headings; `None` if no
/// row has all required ones.
pub(crate) fn find(grid: &Grid, sought: &[&Sought]) -> Option<(Vec<Option<Found>>, usize)> {
    grid.rows.iter().take(HEAD_ROWS).enumerate().find_map(|(row, cells)| {
        let headings: Vec<(String, Option<String>)> = cells.iter().map(|cell| parts(cell)).collect();
        let column_of = |sought: &&Sought| {
            let place = |wanted: &&str| headings.iter().position(|(name, _)| name == wanted);
            let column = sought.headings.iter().find_map(place)?;
            let (heading, unit) = (cells[column].clone(), headings[column].1.clone());
            Some(Found { column, name: column_name(column), heading, unit })
        };
        let mut found: Vec<Option<Found>> = sought.iter().map(column_of).collect();
        if sought.iter().zip(&found).any(|(sought, found)| sought.is_required && found.is_none()) {
            return None;
        }
        // A row of units below the headings.
        let below = grid.rows.get(row + 1);
        let cell = |column: usize| below.and_then(|cells| cells.get(column)).map_or("", String::as_str);
        let columns = || found.iter().flatten().map(|found| cell(found.column));
        let has_units = columns().any(|cell| !cell.is_empty())
            && columns().all(|cell| !cell.contains(|sign: char| sign.is_ascii_digit()));
        if has_units {
            for found in found.iter_mut().flatten() {
                let unit = cell(found.column).trim_matches(['(', ')', '[', ']']).trim();
                found.unit = found.unit.take().or_else(|| (!unit.is_empty()).then(|| unit.to_owned()));
            }
        }
        Some((found, row + 1 + usize::from(has_units)))
    })
}

/// Words in brackets that are part of a name and no unit.
const QUALIFIERS: [&str; 14] = [
    "each",
    "total",
    "air",
    "in air",
    "body",
    "tube",
    "nominal",
    "max",
    "mean",
    "average",
    "cumulative",
    "cum",
    "md",
    "per joint",
];

/// Units that may follow a name without brackets: `MD_ft`, `MD m`, `Weight lb/ft`.
const UNITS: [&str; 18] = [
    "m", "ft", "deg", "dega", "in", "inch", "inches", "mm", "\"", "lb/ft", "lbs/ft", "ppf", "kg/m", "lb",
    "lbs", "lbf", "kg", "kN",
];

/// Name and unit of a heading: `Meas. Depth (ft)`, `MD[m]`, `Inc, deg`, `Incl °`, `Length (each) (m)`; a heading that is a unit is both: `lb/ft`.
fn parts(heading: &str) -> (String, Option<String>) {
    let is_unit = |text: &str| UNITS.iter().any(|unit| unit.eq_ignore_ascii_case(text));
    let (mut name, mut unit) = (String::new(), "");
    let heading = heading.trim();
    match heading.split_once(['(', '[', '<', '{', ',', ';']) {
        Some((start, rest)) => {
            name.push_str(start);
            for part in rest.split(['(', '[', '<', '{', ',', ';']) {
                let part = part.trim_matches([')', ']', '>', '}', ' ']);
                if QUALIFIERS.iter().any(|word| word.eq_ignore_ascii_case(part)) {
                    name.push_str(part);
                } else {
                    unit = part;
                }
            }
        }
        None => match heading.strip_suffix('°') {
            Some(start) => (name, unit) = (start.to_owned(), "°"),
            None => match heading.rsplit_once(['_', ' ']) {
                Some((start, last)) if is_unit(last) => (name, unit) = (start.to_owned(), last),
                _ if heading.contains('/') && is_unit(heading) || heading.eq_ignore_ascii_case("ppf") => {
                    (name, unit) = (heading.to_owned(), heading);
                }
                _ => name.push_str(heading),
            },
        },
    }
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
            ("Length (each) [ft]", "lengtheach", Some("ft")),
            ("Weight (in air), lbf", "weightinair", Some("lbf")),
            ("O.D. \"", "od", Some("\"")),
            ("Lb/ft", "lbft", Some("Lb/ft")),
        ] {
            assert_eq!(parts(heading), (name.to_owned(), unit.map(str::to_owned)), "{heading}");
        }
    }
}
