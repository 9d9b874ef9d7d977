//! Drillpipe, heavy-weight drillpipe and collars by the names that drillers use (docs/model/beam.md, Catalogue).

use std::collections::BTreeSet;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::format::{from_table, table};
use crate::nearest::did_you_mean;
use crate::{Grade, SectionKind, ToolJoint};

/// Number of names that an ambiguous one is answered with.
const MOST_NAMES: usize = 6;

/// Bytes of a name from which it is none.
const LONGEST: usize = 100;

/// A pipe of the catalogue: a section of a string without its length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CataloguePipe {
    /// Name, such as `5" 19.5# S-135 NC50`, as `pipe` of a section has it.
    pub name: String,
    /// Kind.
    pub kind: SectionKind,
    /// Outer diameter of the body \[m\].
    pub outer_diameter: f64,
    /// Inner diameter of the body \[m\].
    pub inner_diameter: f64,
    /// Mean mass of a metre with tool joints \[kg/m\].
    pub mass_per_length: f64,
    /// Tool joints; none of a collar.
    pub tool_joint: Option<ToolJoint>,
    /// Grade.
    pub grade: Grade,
    #[serde(skip)]
    words: BTreeSet<String>,
}

/// The catalogue.
pub static CATALOGUE: LazyLock<Vec<CataloguePipe>> = LazyLock::new(|| {
    let table = table(include_str!("../catalogue.toml")).expect("the catalogue is TOML");
    let Document { string: Sections { mut sections } } = from_table(table).expect("a catalogue of pipes");
    sections.iter_mut().for_each(|pipe| pipe.words = words(&pipe.name));
    sections
});

/// The catalogue as a part of a scenario, whose paths decide units.
#[derive(Deserialize)]
struct Document {
    string: Sections,
}

#[derive(Deserialize)]
struct Sections {
    sections: Vec<CataloguePipe>,
}

/// The one pipe whose name has all words of a text.
///
/// # Errors
/// No pipe or several have them: the nearest one, or the names that there are.
pub(crate) fn pipe(name: &str) -> Result<&'static CataloguePipe, String> {
    if name.len() > LONGEST {
        return Err(format!("the catalogue's names have at most {LONGEST} bytes"));
    }
    let wanted = words(name);
    let found: Vec<&CataloguePipe> = CATALOGUE.iter().filter(|pipe| wanted.is_subset(&pipe.words)).collect();
    match found.as_slice() {
        [one] => Ok(one),
        [] => {
            let question = did_you_mean(name, CATALOGUE.iter().map(|pipe| pipe.name.as_str()));
            Err(format!(
                "the catalogue has no pipe {name}; {question}its names read like 5\" 19.5# S-135 NC50, 5\" HWDP or 6 1/2\" x 2 13/16\" collar"
            ))
        }
        several => {
            let names: Vec<&str> = several.iter().take(MOST_NAMES).map(|pipe| pipe.name.as_str()).collect();
            let more = several.len().saturating_sub(MOST_NAMES);
            let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
            Err(format!(
                "the catalogue has {} pipes of the name {name}: {}{rest}",
                several.len(),
                names.join(", ")
            ))
        }
    }
}

/// Words that distinguish pipes: numbers as decimals, names without case and hyphens, no units.
fn words(name: &str) -> BTreeSet<String> {
    let spaced: String = name
        .to_lowercase()
        .chars()
        .map(|c| if matches!(c, '"' | '#' | '\u{201d}' | ',') { ' ' } else { c })
        .collect();
    let mut words: Vec<String> = Vec::new();
    for word in spaced.split_whitespace() {
        let number = number(word);
        // A fraction belongs to the whole number before it.
        if word.contains('/')
            && let Some(fraction) = number
            && let Some(whole) = words.last().and_then(|whole| whole.parse::<u32>().ok())
        {
            words.pop();
            words.push((f64::from(whole) + fraction).to_string());
        } else if let Some(number) = number {
            words.push(number.to_string());
        } else {
            words.push(word.replace('-', ""));
        }
    }
    let mut words: BTreeSet<String> = words.into_iter().collect();
    for unit in ["in", "inch", "lb/ft", "lbs/ft", "ppf", "x", "drillpipe", "drill", "pipe", "dp"] {
        words.remove(unit);
    }
    if words.remove("dc") {
        words.insert("collar".to_owned());
    }
    words
}

/// A number such as `19.50`, `1/2` or `5-1/2`.
fn number(word: &str) -> Option<f64> {
    if let Some((whole, fraction)) = word.split_once('-') {
        return Some(
            f64::from(whole.parse::<u32>().ok()?) + number(fraction).filter(|_| fraction.contains('/'))?,
        );
    }
    match word.split_once('/') {
        Some((top, bottom)) => {
            let [top, bottom] = [top, bottom].map(|part| part.parse::<u32>().ok());
            Some(f64::from(top?) / f64::from(bottom.filter(|&bottom| bottom > 0)?))
        }
        None => word.starts_with(|c: char| c.is_ascii_digit()).then(|| word.parse().ok())?,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;

    use super::*;

    #[test]
    fn names_are_found_as_drillers_write_them() {
        let whole = pipe("5\" 19.5# S-135 NC50").unwrap();
        assert_eq!((whole.outer_diameter, whole.inner_diameter), (0.127, 0.108_610_4));
        assert_eq!(whole.grade, Grade::S135);
        for same in ["5 in 19.50 lb/ft S135 NC50", "NC50 s-135 19.5# 5\"", "5\u{201d} 19.5# DP S-135 nc50"] {
            assert_eq!(pipe(same).unwrap().name, whole.name, "{same}");
        }
        assert_eq!(pipe("5-1/2\" 21.90# G105 5 1/2 FH").unwrap().outer_diameter, 0.1397);
        assert_eq!(pipe("5\" HWDP").unwrap().name, "5\" 49.3# HWDP NC50");
        assert_eq!(pipe("6.5 x 2 13/16 DC").unwrap().name, "6 1/2\" x 2 13/16\" collar NC46-65");
    }

    #[test]
    fn other_names_are_refused_with_those_that_there_are() {
        for (name, part) in [
            ("5\" 19.5# S-135", "has 2 pipes of the name 5\" 19.5# S-135: "),
            ("HWDP", "has 8 pipes"),
            ("", " and "),
            ("5\" 19.5# S-135 NC5O", "did you mean 5\" 19.5# S-135 NC50?"),
            ("casing", "its names read like"),
            ("5 1/0\"", "has no pipe"),
            (&"5".repeat(500), "at most 100 bytes"),
        ] {
            let refused = pipe(name).unwrap_err();
            assert!(refused.contains(part), "{name}: {refused}");
        }
    }

    #[test]
    fn weights_are_those_of_the_dimensions() {
        // Steel of 7,850 kg/m3, a piece of 9.4 m (range 2). The dimensions lack the upsets (up to 19 lb) and the taper of the box (some 15 lb) of 600 lb.
        let steel = |outer: f64, inner: f64| 7850.0 * FRAC_PI_4 * (outer * outer - inner * inner);
        for pipe in CATALOGUE.iter() {
            let body = steel(pipe.outer_diameter, pipe.inner_diameter);
            let mean = pipe.tool_joint.map_or(body, |joint| {
                let joints = 2.0 * joint.length / 9.4;
                (1.0 - joints) * body + joints * steel(joint.outer_diameter, joint.inner_diameter)
            });
            let ratio = pipe.mass_per_length / mean;
            assert!((0.98..1.06).contains(&ratio), "{}: {ratio}", pipe.name);
            assert!(pipe.tool_joint.is_some() == (pipe.kind == SectionKind::Drillpipe), "{}", pipe.name);
        }
    }

    #[test]
    fn every_name_is_its_own() {
        for entry in CATALOGUE.iter() {
            let found = pipe(&entry.name).unwrap();
            assert_eq!(found.name, entry.name);
        }
    }
}
