//! Scenarios as they are stored.

/// Text of a scenario: a base that many points share, and what one of them changes in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScenarioText {
    /// The base as JSON text.
    pub base_json: String,
    /// The changes as a JSON object by path.
    pub changes_json: String,
}
