//! Points of a sweep and what came of them.

use serde_json::Value;

use crate::engine::query::{Row, query};
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;
use crate::work::scenario::ScenarioText;
use crate::work::state::{WorkKey, WorkState, work_key};

/// A stored point.
#[derive(Debug, Clone, PartialEq)]
pub struct PointRecord {
    /// Number in the sweep, from 1.
    pub ordinal: i64,
    /// The swept parameters as a JSON object.
    pub parameters_json: String,
    /// Content hash.
    pub work_key: WorkKey,
    /// The scenario; left out of lists.
    pub scenario: Option<ScenarioText>,
    /// State of its work.
    pub state: WorkState,
    /// Simulated time over duration, 0 to 1.
    pub progress: f64,
    /// Number of attempts.
    pub attempts: i64,
    /// Reason of its failure, as JSON.
    pub error_json: Option<String>,
    /// Scalar results as a JSON object.
    pub summary_json: Option<String>,
    /// Provenance of its result, as a JSON object.
    pub provenance_json: Option<String>,
}

/// A point's row of the sweep's table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableRecord {
    /// Number in the sweep, from 1.
    pub ordinal: i64,
    /// The swept parameters as a JSON object.
    pub parameters_json: String,
    /// State of its work.
    pub state: WorkState,
    /// Scalar results as a JSON object.
    pub summary_json: Option<String>,
    /// Reason of its failure, as JSON.
    pub error_json: Option<String>,
}

/// A stored array or table of a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Artifact {
    /// Name within the result.
    pub name: String,
    /// Media type of the blob.
    pub media_type: String,
    /// Name of the blob.
    pub blob: String,
    /// Size of the blob.
    pub bytes: i64,
    /// Rows of the table.
    pub row_count: i64,
    /// Time at which its blob was given up \[ms since the epoch\].
    pub expired: Option<i64>,
}

impl Store {
    /// Points of a sweep after the ordinal `after`, in some states or in any, without their results.
    ///
    /// # Errors
    /// The database fails.
    pub async fn points(
        &self,
        sweep_id: &str,
        states: &[WorkState],
        after: i64,
        limit: i64,
    ) -> Result<Vec<PointRecord>> {
        let names = states.iter().map(|state| state.as_str());
        let wanted = (!states.is_empty()).then(|| names.collect::<Value>().to_string());
        query(sql::point::LIST)
            .bind(sweep_id)
            .bind(after)
            .bind(wanted)
            .bind(limit)
            .records(&self.database, PointRecord::read)
            .await
    }

    /// One point with its result, if it has one; none if there is no such point.
    ///
    /// # Errors
    /// The database fails.
    pub async fn point(&self, sweep_id: &str, ordinal: i64) -> Result<Option<PointRecord>> {
        query(sql::point::ONE)
            .bind(sweep_id)
            .bind(ordinal)
            .first_record(&self.database, PointRecord::read)
            .await
    }

    /// One row a point, for the sweep's table, in order: `limit` points at most, after the ordinal `after`.
    ///
    /// # Errors
    /// The database fails.
    pub async fn table_rows(&self, sweep_id: &str, after: i64, limit: i64) -> Result<Vec<TableRecord>> {
        type Row = (i64, String, String, Option<String>, Option<String>);
        let rows: Vec<Row> =
            query(sql::point::TABLE).bind(sweep_id).bind(after).bind(limit).rows(&self.database).await?;
        rows.into_iter()
            .map(|(ordinal, parameters_json, state, summary_json, error_json)| {
                Ok(TableRecord {
                    ordinal,
                    parameters_json,
                    state: WorkState::parse(&state)?,
                    summary_json,
                    error_json,
                })
            })
            .collect()
    }

    /// Points of a sweep after the ordinal `after` that have artifacts, with these, in order; `limit` points at most. Artifacts that
    /// have expired are among them.
    ///
    /// # Errors
    /// The database fails.
    pub async fn point_artifacts(
        &self,
        sweep_id: &str,
        after: i64,
        limit: i64,
    ) -> Result<Vec<(i64, WorkKey, Vec<Artifact>)>> {
        let rows: Vec<(i64, Vec<u8>, Artifact)> = query(sql::point::WITH_ARTIFACTS)
            .bind(sweep_id)
            .bind(after)
            .bind(limit)
            .records(&self.database, |row| {
                Ok((row.get::<i64>("ordinal")?, row.get::<Vec<u8>>("work_key")?, Artifact::read(row)?))
            })
            .await?;
        let mut points: Vec<(i64, WorkKey, Vec<Artifact>)> = Vec::new();
        for (ordinal, key, artifact) in rows {
            match points.last_mut() {
                Some((last, _, artifacts)) if *last == ordinal => artifacts.push(artifact),
                _ => points.push((ordinal, work_key(&key)?, vec![artifact])),
            }
        }
        Ok(points)
    }

    /// Artifacts of a result, by name; none before it is there.
    ///
    /// # Errors
    /// The database fails.
    pub async fn artifacts(&self, key: &WorkKey) -> Result<Vec<Artifact>> {
        query(sql::point::ARTIFACTS).bind(key.as_slice()).records(&self.database, Artifact::read).await
    }
}

impl PointRecord {
    pub(crate) fn read(row: &Row) -> Result<Self> {
        let base: Option<String> = row.get("base")?;
        let changes: Option<String> = row.get("changes")?;
        Ok(Self {
            ordinal: row.get("ordinal")?,
            parameters_json: row.get("parameters")?,
            work_key: work_key(&row.get::<Vec<u8>>("key")?)?,
            scenario: base
                .zip(changes)
                .map(|(base_json, changes_json)| ScenarioText { base_json, changes_json }),
            state: WorkState::parse(&row.get::<String>("state")?)?,
            progress: row.get("progress")?,
            attempts: row.get("attempts")?,
            error_json: row.get("error")?,
            summary_json: row.get("summary")?,
            provenance_json: row.get("provenance")?,
        })
    }
}

impl Artifact {
    fn read(row: &Row) -> Result<Self> {
        Ok(Self {
            name: row.get("name")?,
            media_type: row.get("media_type")?,
            blob: row.get("blob")?,
            bytes: row.get("bytes")?,
            row_count: row.get("row_count")?,
            expired: row.get("expired")?,
        })
    }
}
