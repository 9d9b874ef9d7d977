//! Points of a sweep and what came of them.

use serde_json::Value;
use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

use crate::connection::Store;
use crate::error::Result;
use crate::sql;
use crate::state::{WorkKey, WorkState, work_key};

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
    /// Where its work stands.
    pub state: WorkState,
    /// Simulated time over duration, 0 to 1.
    pub progress: f64,
    /// How often a worker has started it.
    pub attempts: i64,
    /// Why it failed, as JSON.
    pub error_json: Option<String>,
    /// Scalar results as a JSON object.
    pub summary_json: Option<String>,
    /// Where and how it was computed, as a JSON object.
    pub provenance_json: Option<String>,
}

/// A scenario as it is stored: a base that many points share, and what one of them changes in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScenarioText {
    /// The base as JSON text.
    pub base_json: String,
    /// The changes as a JSON object by path.
    pub changes_json: String,
}

/// A point's row of the sweep's table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableRecord {
    /// Number in the sweep, from 1.
    pub ordinal: i64,
    /// The swept parameters as a JSON object.
    pub parameters_json: String,
    /// Where its work stands.
    pub state: WorkState,
    /// Scalar results as a JSON object.
    pub summary_json: Option<String>,
    /// Why it failed, as JSON.
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
    /// When its blob was given up \[ms since the epoch\].
    pub expired: Option<i64>,
}

impl Store {
    /// Points of a sweep after the ordinal `after`, in some states or in any, without their results.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn points(
        &self,
        sweep_id: &str,
        states: &[WorkState],
        after: i64,
        limit: i64,
    ) -> Result<Vec<PointRecord>> {
        let names = states.iter().map(|state| state.as_str());
        let wanted = (!states.is_empty()).then(|| names.collect::<Value>().to_string());
        let rows = sqlx::query(sql::point::LIST)
            .bind(sweep_id)
            .bind(after)
            .bind(wanted)
            .bind(limit)
            .fetch_all(&self.pool)
            .await?;
        rows.iter().map(PointRecord::read).collect()
    }

    /// One point with its result, if it has one; none if there is no such point.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn point(&self, sweep_id: &str, ordinal: i64) -> Result<Option<PointRecord>> {
        let row =
            sqlx::query(sql::point::ONE).bind(sweep_id).bind(ordinal).fetch_optional(&self.pool).await?;
        row.as_ref().map(PointRecord::read).transpose()
    }

    /// One row a point, for the sweep's table, in order.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn table_rows(&self, sweep_id: &str) -> Result<Vec<TableRecord>> {
        type Row = (i64, String, String, Option<String>, Option<String>);
        let rows: Vec<Row> = sqlx::query_as(sql::point::TABLE).bind(sweep_id).fetch_all(&self.pool).await?;
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
    /// When the database fails.
    pub async fn point_artifacts(
        &self,
        sweep_id: &str,
        after: i64,
        limit: i64,
    ) -> Result<Vec<(i64, WorkKey, Vec<Artifact>)>> {
        let rows = sqlx::query(sql::point::WITH_ARTIFACTS)
            .bind(sweep_id)
            .bind(after)
            .bind(limit)
            .fetch_all(&self.pool)
            .await?;
        let mut points: Vec<(i64, WorkKey, Vec<Artifact>)> = Vec::new();
        for row in &rows {
            let ordinal = row.try_get("ordinal")?;
            let artifact = Artifact::read(row)?;
            match points.last_mut() {
                Some((last, _, artifacts)) if *last == ordinal => artifacts.push(artifact),
                _ => points.push((ordinal, work_key(row.try_get("work_key")?)?, vec![artifact])),
            }
        }
        Ok(points)
    }

    /// Artifacts of a result, by name; none before it is there.
    ///
    /// # Errors
    /// When the database fails.
    pub async fn artifacts(&self, key: &WorkKey) -> Result<Vec<Artifact>> {
        let rows = sqlx::query(sql::point::ARTIFACTS).bind(key.as_slice()).fetch_all(&self.pool).await?;
        rows.iter().map(Artifact::read).collect()
    }
}

impl PointRecord {
    pub(crate) fn read(row: &SqliteRow) -> Result<Self> {
        let base: Option<String> = row.try_get("base")?;
        let changes: Option<String> = row.try_get("changes")?;
        Ok(Self {
            ordinal: row.try_get("ordinal")?,
            parameters_json: row.try_get("parameters")?,
            work_key: work_key(row.try_get("key")?)?,
            scenario: base
                .zip(changes)
                .map(|(base_json, changes_json)| ScenarioText { base_json, changes_json }),
            state: WorkState::parse(row.try_get("state")?)?,
            progress: row.try_get("progress")?,
            attempts: row.try_get("attempts")?,
            error_json: row.try_get("error")?,
            summary_json: row.try_get("summary")?,
            provenance_json: row.try_get("provenance")?,
        })
    }
}

impl Artifact {
    fn read(row: &SqliteRow) -> Result<Self> {
        Ok(Self {
            name: row.try_get("name")?,
            media_type: row.try_get("media_type")?,
            blob: row.try_get("blob")?,
            bytes: row.try_get("bytes")?,
            row_count: row.try_get("row_count")?,
            expired: row.try_get("expired")?,
        })
    }
}
