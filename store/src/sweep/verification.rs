//! Points of a sweep with the runs that verify them.

use crate::engine::query::query;
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;
use crate::work::state::{WorkKey, WorkState, work_key};

/// A point that is verified, and the run that verifies it.
#[derive(Debug, Clone, PartialEq)]
pub struct VerificationRecord {
    /// Number of the point in the sweep, from 1.
    pub ordinal: i64,
    /// The swept parameters as a JSON object.
    pub parameters_json: String,
    /// Scalar results of the point as a JSON object, once it has some.
    pub summary_json: Option<String>,
    /// Content hash of the run.
    pub work_key: WorkKey,
    /// State of the run.
    pub state: WorkState,
    /// Reason of the run's failure, as JSON.
    pub error_json: Option<String>,
    /// Scalar results of the run as a JSON object, once it has some.
    pub reference_json: Option<String>,
}

impl Store {
    /// The points of a sweep that are verified, in order.
    ///
    /// # Errors
    /// The database fails.
    pub async fn verifications(&self, sweep_id: &str) -> Result<Vec<VerificationRecord>> {
        type Row = (i64, String, Option<String>, Vec<u8>, String, Option<String>, Option<String>);
        let rows: Vec<Row> = query(sql::verification::LIST).bind(sweep_id).rows(&self.database).await?;
        rows.into_iter()
            .map(|(ordinal, parameters_json, summary_json, key, state, error_json, reference_json)| {
                Ok(VerificationRecord {
                    ordinal,
                    parameters_json,
                    summary_json,
                    work_key: work_key(&key)?,
                    state: WorkState::parse(&state)?,
                    error_json,
                    reference_json,
                })
            })
            .collect()
    }
}
