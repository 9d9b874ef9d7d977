//! Points of a sweep: a base scenario and numbers in place of its own.

use indexmap::IndexMap;
use serde_json::{Value, json};

use crate::{Problem, Scenario};

/// The scenario of a stored point: its base with its changes, both as JSON text.
///
/// # Errors
/// Either text is not of a form that a release of the same physics version writes.
pub fn compose(base: &str, changes: &str) -> Result<Scenario, Problem> {
    let mut scenario = Scenario::from_json(base)?;
    let malformed = |error: serde_json::Error| Problem {
        path: String::new(),
        got: String::new(),
        message: format!("the point's changes cannot be read: {error}"),
    };
    let changes: IndexMap<String, f64> = serde_json::from_str(changes).map_err(malformed)?;
    for (path, value) in changes {
        scenario.set_number(&path, value)?;
    }
    Ok(scenario)
}

impl Scenario {
    /// Sets a numeric field. Whole numbers are converted by the written form, which reports the problems of others.
    ///
    /// # Errors
    /// A path that names no field, or a number that the field cannot hold.
    pub fn set_number(&mut self, path: &str, value: f64) -> Result<(), Problem> {
        match self.number_mut(path) {
            Some(number) => *number = value,
            None => {
                let refused = |problem: Problem| match problem.got.as_str() {
                    "" => problem,
                    _ => Problem { got: json_number(value).to_string(), ..problem },
                };
                *self = self.with(path, json_number(value)).map_err(refused)?;
            }
        }
        Ok(())
    }
}

/// A number as JSON, a whole one without its decimal point.
pub fn json_number(value: f64) -> Value {
    const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;
    if value.fract() == 0.0 && value.abs() <= LARGEST_WHOLE && !(value == 0.0 && value.is_sign_negative()) {
        json!(value as i64)
    } else {
        json!(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset;

    #[test]
    fn a_stored_point_is_its_base_with_its_changes() {
        let base = preset("paper-200m").unwrap();
        let changes = r#"{"accuracy.step": 0.001, "ensemble": 4, "mud.flow_rate": 0.02}"#;
        let wanted = ["accuracy.step", "ensemble", "mud.flow_rate"].into_iter().zip([
            json!(0.001),
            json!(4),
            json!(0.02),
        ]);
        let wanted = wanted.fold(base.clone(), |scenario, (path, value)| scenario.with(path, value).unwrap());
        assert_eq!(compose(&base.to_json(), changes).unwrap(), wanted);
    }

    #[test]
    fn changes_that_no_release_writes_are_problems() {
        let base = preset("paper-200m").unwrap().to_json();
        let refused = |changes| compose(&base, changes).unwrap_err();
        assert!(refused("[]").message.contains("cannot be read"));
        assert!(refused(r#"{"mud.flow_rate": "fast"}"#).message.contains("cannot be read"));
        assert_eq!(refused(r#"{"mud.speed": 1}"#).path, "mud.speed");
        assert_eq!(refused(r#"{"ensemble": 1.5}"#).got, "1.5");
    }
}
