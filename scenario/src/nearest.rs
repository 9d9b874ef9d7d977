//! The name that was meant in place of one that there is not.

use crate::{PRESETS, Problem};

/// Jaro's similarity from which a name counts as misspelt: a letter too few or two that are swapped, a folder that is left out.
const SIMILAR: f64 = 0.72;

/// Bytes of a name from which it resembles none.
const LONGEST: usize = 256;

/// The most similar of some names, if it is likely meant.
pub fn nearest<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // The comparison is quadratic, and no name is as long.
    if name.len() > LONGEST {
        return None;
    }
    let name = name.to_lowercase();
    names
        .into_iter()
        .map(|candidate| (strsim::jaro(&name, candidate), candidate))
        .filter(|(similarity, _)| *similarity >= SIMILAR)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, candidate)| candidate)
}

/// The question whether the most similar of some names was meant, followed by a space, or nothing.
pub(crate) fn did_you_mean<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, names).map_or_else(String::new, |nearest| format!("did you mean {nearest}? "))
}

/// The problem of a name that no preset has, at the path `preset`: with the most similar name, if one is likely meant, and all names.
pub fn unknown_preset(name: &str) -> Problem {
    let names: Vec<&str> = PRESETS.iter().map(|(name, _)| *name).collect();
    let question = did_you_mean(name, names.iter().copied());
    Problem::new("preset", name, format!("there is no such preset; {question}there are {}", names.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_presets_are_recognised() {
        for (name, meant) in [
            ("papre-200m", "paper-200m"),
            ("paper200m", "paper-200m"),
            ("Paper-200m-Dry", "paper-200m-dry"),
            ("paper-200m-dyr", "paper-200m-dry"),
            ("heavy-mud", "hard/heavy-mud"),
            ("hard/stickslip", "hard/stick-slip"),
            ("closed/string-100m", "closed/string-1000m"),
        ] {
            let problem = unknown_preset(name);
            assert!(
                problem.message.contains(&format!("; did you mean {meant}? there are paper")),
                "{problem}"
            );
        }
        for name in ["", "x", "north-sea", "well.toml", "\u{1f6e2}"] {
            let problem = unknown_preset(name);
            assert!(!problem.message.contains("did you mean"), "{problem}");
        }
    }
}
