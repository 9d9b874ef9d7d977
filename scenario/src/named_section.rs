//! Sections of a string by their names.

use std::collections::BTreeMap;

use crate::nearest::did_you_mean;

/// Names with which a name is compared to find the one that was meant.
const MOST_COMPARED: usize = 200;

/// Place of a section that has a name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedSection {
    /// Its index in `string.sections`.
    pub index: usize,
    /// Measured depth of its lower end \[m\].
    pub bottom: f64,
    /// Length of all of its pieces \[m\].
    pub length: f64,
}

/// Sections of a string by their names.
#[derive(Debug, Clone, Default)]
pub struct NamedSections<'s>(BTreeMap<&'s str, Vec<NamedSection>>);

/// Reasons why a name identifies no section.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SectionNameError {
    /// No section has the name.
    #[error("{meant}no section of the string has this name")]
    Unknown {
        /// The question whether a similar name was meant, or nothing.
        meant: String,
    },
    /// Several sections have the name.
    #[error(
        "{count} sections have this name, the first are string.sections[{first}] and string.sections[{second}]: give each its own"
    )]
    Ambiguous {
        /// Number of these sections.
        count: usize,
        /// Index of the first from the top.
        first: usize,
        /// Index of the second.
        second: usize,
    },
}

impl<'s> NamedSections<'s> {
    /// Sections with their names from the top down; those with an empty name are left out.
    pub(crate) fn new(sections: impl Iterator<Item = (&'s str, NamedSection)>) -> Self {
        let mut named: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for (name, section) in sections.filter(|(name, _)| !name.is_empty()) {
            named.entry(name).or_default().push(section);
        }
        Self(named)
    }

    /// The one section of a name; absent if no section has it, or several have it.
    pub(crate) fn only(&self, name: &str) -> Option<NamedSection> {
        let [section] = self.0.get(name)?[..] else { return None };
        Some(section)
    }

    /// The one section of a name.
    ///
    /// # Errors
    /// No section has the name, or several have it.
    pub fn find(&self, name: &str) -> Result<NamedSection, SectionNameError> {
        match self.0.get(name).map_or(&[][..], Vec::as_slice) {
            [section] => Ok(*section),
            [] => {
                let names = self.0.keys().take(MOST_COMPARED).copied();
                Err(SectionNameError::Unknown { meant: did_you_mean(name, names) })
            }
            all @ [first, second, ..] => Err(SectionNameError::Ambiguous {
                count: all.len(),
                first: first.index,
                second: second.index,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset;

    #[test]
    fn a_name_identifies_one_section() {
        let mut string = preset("paper-200m").unwrap().string;
        for (index, name) in ["pipe", "motor", "collar", "collar", "collar"].into_iter().enumerate() {
            string.sections[index].name = name.to_owned();
        }
        let named = string.named_sections();
        assert_eq!(named.find("motor").map(|section| section.index), Ok(1));
        let words = |name: &str| named.find(name).unwrap_err().to_string();
        assert_eq!(words("mtor"), "did you mean motor? no section of the string has this name");
        assert_eq!(words("jar"), "no section of the string has this name");
        assert_eq!(words(""), "no section of the string has this name");
        let ambiguous = SectionNameError::Ambiguous { count: 3, first: 2, second: 3 };
        assert_eq!(named.find("collar").unwrap_err(), ambiguous);
        let only = ["motor", "jar", "", "collar"].map(|name| named.only(name).is_some());
        assert_eq!(only, [true, false, false, false]);
    }
}
