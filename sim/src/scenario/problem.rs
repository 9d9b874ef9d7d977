//! What is wrong with a scenario, and where.

use std::fmt;

use serde::Serialize;

/// One reason why a scenario cannot be read or simulated.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, thiserror::Error)]
pub struct Problem {
    /// Path of the field in the scenario, such as `string.sections[1].count`; empty for the whole document.
    pub path: String,
    /// What was found there; empty if the message says it.
    pub got: String,
    /// What would be valid.
    pub message: String,
}

impl Problem {
    pub(crate) fn new(path: impl Into<String>, got: impl Into<String>, message: impl Into<String>) -> Self {
        Self { path: path.into(), got: got.into(), message: message.into() }
    }

    /// The path as a JSON Pointer (RFC 6901): `/string/sections/1/count`.
    pub fn pointer(&self) -> String {
        pointer(&self.path)
    }

    /// A problem from the words of a serde error: what it got and what it expected are separated, and Rust's
    /// names of types become words.
    pub fn from_serde(path: String, message: &str) -> Self {
        let parted = ["invalid type: ", "invalid value: "]
            .iter()
            .find_map(|prefix| message.strip_prefix(prefix)?.rsplit_once(", expected "));
        let path = if path == "." { String::new() } else { path };
        match parted {
            Some((got, expected)) => Self::new(path, got, format!("must be {}", in_words(expected))),
            None => Self::new(path, "", message),
        }
    }
}

/// What serde expected, without Rust's names of types.
fn in_words(expected: &str) -> &str {
    let names_a_type = |kinds: &[&str]| {
        kinds.iter().any(|kind| expected.strip_prefix(kind).is_some_and(|rest| rest.starts_with(' ')))
    };
    match expected {
        "f64" | "f32" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, 0 or more",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        "a map" => "an object",
        _ if names_a_type(&[
            "struct",
            "struct variant",
            "internally tagged enum",
            "adjacently tagged enum",
        ]) =>
        {
            "an object"
        }
        _ if names_a_type(&["enum"]) => "a name, or an object with a name as its only field",
        other => other,
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        f.write_str(&self.message)?;
        if !self.got.is_empty() {
            write!(f, " (got {})", self.got)?;
        }
        Ok(())
    }
}

/// Everything that is wrong with a scenario, at least one problem.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, thiserror::Error)]
pub struct Problems(pub Vec<Problem>);

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.0.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            problem.fmt(f)?;
        }
        Ok(())
    }
}

impl From<Problem> for Problems {
    fn from(problem: Problem) -> Self {
        Self(vec![problem])
    }
}

/// Something that can be simulated but is probably not meant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// Path of the field in the scenario.
    pub path: String,
    /// What will happen, and what may have been meant.
    pub message: String,
}

impl Warning {
    /// The path as a JSON Pointer (RFC 6901).
    pub fn pointer(&self) -> String {
        pointer(&self.path)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path, self.message)
    }
}

fn pointer(path: &str) -> String {
    path.split(['.', '['])
        .filter(|part| !part.is_empty())
        .map(|part| {
            let key = part.strip_suffix(']').unwrap_or(part);
            format!("/{}", key.replace('~', "~0").replace('/', "~1"))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_json_pointers() {
        let pointer = |path: &str| Problem::new(path, "", "").pointer();
        assert_eq!(pointer("string.sections[1].count"), "/string/sections/1/count");
        assert_eq!(pointer("duration"), "/duration");
        assert_eq!(pointer(""), "");
        assert_eq!(pointer("a/b.c~d"), "/a~1b/c~0d");
    }

    #[test]
    fn problems_read_as_lines() {
        let problems = Problems(vec![
            Problem::new("mud.density", "-1", "must be greater than 0"),
            Problem::new("", "", "not TOML"),
        ]);
        assert_eq!(problems.to_string(), "mud.density: must be greater than 0 (got -1)\nnot TOML");
    }
}
