//! Problems of a scenario, with their places.

use std::fmt;

use serde::Serialize;

use crate::nearest::did_you_mean;

/// One reason why a scenario cannot be read or simulated.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, thiserror::Error)]
pub struct Problem {
    /// Path of the field in the scenario, such as `string.sections[1].count`; empty for the whole document.
    pub path: String,
    /// Value found there; empty if the message gives it.
    pub got: String,
    /// Description of a valid value.
    pub message: String,
}

impl Problem {
    /// A problem at a path, with the value found there and the valid ones.
    pub fn new(path: impl Into<String>, got: impl Into<String>, message: impl Into<String>) -> Self {
        Self { path: path.into(), got: got.into(), message: message.into() }
    }

    /// The path as a JSON Pointer (RFC 6901): `/string/sections/1/count`.
    pub fn pointer(&self) -> String {
        pointer(&self.path)
    }

    /// A problem from the message of a serde error, in words that need no Rust: what it got and what it expected are separated, names of
    /// types, variants and fields become those of the document.
    pub fn from_serde(path: String, message: &str) -> Self {
        let path = if path == "." { String::new() } else { path };
        let parted = ["invalid type: ", "invalid value: ", "invalid length "]
            .iter()
            .find_map(|prefix| message.strip_prefix(prefix)?.rsplit_once(", expected "));
        if let Some((got, expected)) = parted {
            return Self::new(path, found(got), format!("must be {}", in_words(expected)));
        }
        if let Some((name, choices)) = unknown(message, "variant") {
            return Self::new(path, format!("\"{name}\""), format!("must be {}", listed(&choices, "or")));
        }
        if let Some((name, choices)) = unknown(message, "field") {
            let question = did_you_mean(name, choices.iter().copied());
            let message =
                format!("there is no field `{name}`; {question}there are {}", listed(&choices, "and"));
            return Self::new(path, "", message);
        }
        let of_one_field = |prefix: &str| message.strip_prefix(prefix)?.strip_suffix('`');
        if let Some(name) = of_one_field("missing field `") {
            return Self::new(path, "", format!("the field `{name}` is missing"));
        }
        if let Some(name) = of_one_field("duplicate field `") {
            return Self::new(path, "", format!("the field `{name}` is given twice"));
        }
        Self::new(path, "", message)
    }
}

/// The name and the choices of a message such as "unknown variant `x`, expected `a` or `b`".
fn unknown<'a>(message: &'a str, kind: &str) -> Option<(&'a str, Vec<&'a str>)> {
    let (name, rest) = message.strip_prefix(&format!("unknown {kind} `"))?.split_once("`, ")?;
    // Every other part stands between backticks.
    Some((name, rest.split('`').skip(1).step_by(2).collect()))
}

/// Names as a list that a person reads: "`a`, `b` and `c`".
fn listed(names: &[&str], last: &str) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        None => "none".to_owned(),
        Some((only, [])) => only.clone(),
        Some((end, others)) => format!("{} {last} {end}", others.join(", ")),
    }
}

/// Value or type that serde found, as the document writes it.
fn found(got: &str) -> &str {
    match got {
        "sequence" => "a list",
        "map" => "an object",
        "unit value" => "null",
        _ => {
            let inner = ["string ", "integer ", "floating point ", "boolean ", "character "]
                .iter()
                .find_map(|kind| got.strip_prefix(kind));
            inner.unwrap_or(got).trim_matches('`')
        }
    }
}

/// Type that serde expected, without Rust's names of types.
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
        "string or map" => "a name, or an object with a name as its only field",
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
    /// Consequence, and the value that may have been meant.
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
    fn messages_of_serde_become_words_of_the_document() {
        let text = |message: &str| Problem::from_serde(String::new(), message).to_string();
        let cases = [
            ("invalid type: string \"x\", expected f64", "must be a number (got \"x\")"),
            (
                "invalid type: floating point `1.5`, expected u32",
                "must be a whole number, 0 or more (got 1.5)",
            ),
            ("invalid type: sequence, expected a map", "must be an object (got a list)"),
            ("unknown variant `lin`, expected `linear` or `log`", "must be `linear` or `log` (got \"lin\")"),
            ("unknown variant `x`, expected one of `a`, `b`, `c`", "must be `a`, `b` or `c` (got \"x\")"),
            (
                "unknown field `x`, expected one of `a`, `b`, `c`",
                "there is no field `x`; there are `a`, `b` and `c`",
            ),
            (
                "unknown field `flow`, expected one of `density`, `flow_rate`",
                "there is no field `flow`; did you mean flow_rate? there are `density` and `flow_rate`",
            ),
            ("unknown field `x`, there are no fields", "there is no field `x`; there are none"),
            ("missing field `well`", "the field `well` is missing"),
            ("duplicate field `well`", "the field `well` is given twice"),
            ("must be finite", "must be finite"),
        ];
        for (message, expected) in cases {
            assert_eq!(text(message), expected);
        }
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
