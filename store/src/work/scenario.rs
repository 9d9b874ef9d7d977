//! Scenarios as they are stored.

/// Text of a scenario: a base that many points share, and the changes of one of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScenarioText {
    /// The base as JSON text.
    pub base_json: String,
    /// The changes as a JSON object by path.
    pub changes_json: String,
}
