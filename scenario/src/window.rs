//! Windows of orbits and spectra: chosen by the run once its motion has settled, or fixed beforehand.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use crate::{FEWEST_SAMPLES, Scenario, TimeWindow};

/// The window of the orbit statistics: `"settled"`, or a fixed one of `from` and `to`.
///
/// With `settled` the run goes on in blocks of 10 s until statistics of consecutive windows agree, or until the confidence interval of
/// irregular motion is as narrow as the accuracy promises, and ends there; `duration` is the longest that it may take.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, utoipa::ToSchema)]
#[serde(untagged)]
pub enum OrbitWindow {
    /// Chosen by the run.
    Named(WindowName),
    /// Fixed beforehand.
    Fixed(TimeWindow),
}

/// Windows with a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum WindowName {
    /// The end of the run, once the motion has settled.
    Settled,
}

impl OrbitWindow {
    /// Chosen by the run, once its motion has settled.
    pub const SETTLED: Self = OrbitWindow::Named(WindowName::Settled);
}

impl From<TimeWindow> for OrbitWindow {
    fn from(window: TimeWindow) -> Self {
        OrbitWindow::Fixed(window)
    }
}

impl Scenario {
    /// Whether the run ends once its motion has settled.
    pub fn settles(&self) -> bool {
        self.recording.orbit_window == Some(OrbitWindow::SETTLED)
    }

    /// The fixed window of the orbit statistics: what `recording` gives, or the last third of the run; absent where it is `settled`.
    pub fn orbit_window(&self) -> Option<TimeWindow> {
        match self.recording.orbit_window {
            Some(OrbitWindow::Named(WindowName::Settled)) => None,
            Some(OrbitWindow::Fixed(window)) => Some(window),
            None => Some(self.last_third()),
        }
    }

    /// The last third of the longest run.
    pub fn last_third(&self) -> TimeWindow {
        TimeWindow { from: self.duration * 2.0 / 3.0, to: self.duration }
    }

    /// The fixed windows whose full spectra are summarised: what `recording` gives, or the last sixth of the run, from a sample on;
    /// none where that holds fewer than 8. Absent where it is the settled window.
    pub fn spectrum_windows(&self) -> Option<Vec<TimeWindow>> {
        if let Some(given) = &self.recording.spectrum_windows {
            return Some(given.clone());
        }
        if self.settles() {
            return None;
        }
        let last_sixth = TimeWindow::last(1.0 / 6.0, self.duration, self.recording.rate_hz);
        let samples = (last_sixth.to - last_sixth.from) * self.recording.rate_hz;
        Some(if samples >= FEWEST_SAMPLES { vec![last_sixth] } else { Vec::new() })
    }
}

/// Written out, because an untagged enum would not say which field is wrong.
impl<'de> Deserialize<'de> for OrbitWindow {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OrbitWindowVisitor)
    }
}

struct OrbitWindowVisitor;

impl<'de> Visitor<'de> for OrbitWindowVisitor {
    type Value = OrbitWindow;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("\"settled\", or an object with from and to")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<OrbitWindow, E> {
        WindowName::deserialize(StrDeserializer::new(name)).map(OrbitWindow::Named)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<OrbitWindow, A::Error> {
        TimeWindow::deserialize(MapAccessDeserializer::new(map)).map(OrbitWindow::Fixed)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::preset;

    fn read(value: Value) -> Result<OrbitWindow, String> {
        serde_json::from_value(value).map_err(|error| error.to_string())
    }

    #[test]
    fn both_forms_are_read_and_written() {
        for form in [json!("settled"), json!({"from": 40.0, "to": 60.0})] {
            assert_eq!(serde_json::to_value(read(form.clone()).unwrap()).unwrap(), form);
        }
        assert!(read(json!("steady")).unwrap_err().contains("settled"));
        assert!(read(json!({"from": 40.0})).unwrap_err().contains("to"));
        assert!(read(json!({"from": 40.0, "to": 60.0, "till": 1.0})).unwrap_err().contains("till"));
        assert!(read(json!(20.0)).unwrap_err().contains("\"settled\", or an object"));
    }

    #[test]
    fn an_end_of_a_settled_window_makes_it_fixed_from_the_last_third_on() {
        let mut settled = preset("paper-200m").unwrap();
        settled.recording.orbit_window = Some(OrbitWindow::SETTLED);
        let with = |path: &str| settled.with(path, json!(50.0)).unwrap().orbit_window();
        assert_eq!(with("recording.orbit_window.from"), Some(TimeWindow { from: 50.0, to: 60.0 }));
        assert_eq!(with("recording.orbit_window.to"), Some(TimeWindow { from: 40.0, to: 50.0 }));
        assert_eq!(settled.number_mut("recording.orbit_window.from"), None);
    }

    #[test]
    fn spectra_are_over_the_settled_window_unless_they_have_their_own() {
        let mut scenario = preset("paper-200m").unwrap();
        let own = scenario.spectrum_windows();
        scenario.recording.orbit_window = Some(OrbitWindow::SETTLED);
        assert_eq!((scenario.orbit_window(), scenario.spectrum_windows()), (None, own));
        scenario.recording.spectrum_windows = None;
        assert_eq!(scenario.spectrum_windows(), None);
    }
}
