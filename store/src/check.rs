//! Whether what the store holds is whole: the database's own checks, and every blob against its name.

use crate::blob::BlobId;
use crate::connection::Store;
use crate::error::{Result, StoreError};
use crate::sql;

/// What a check looked at, and what is wrong.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CheckReport {
    /// Results looked at.
    pub results: u64,
    /// Blobs read, each once however many results name it.
    pub blobs: u64,
    /// Their size.
    pub bytes: u64,
    /// What is wrong, one text each; empty where all is well.
    pub problems: Vec<String>,
}

impl Store {
    /// Reads everything and compares: pages and references of the database, finished work against results, sizes and
    /// hashes of the blobs that results name. Changes nothing; the service may run meanwhile.
    ///
    /// # Errors
    /// When the database cannot be read. What can be read but is wrong is reported, not an error.
    pub async fn check(&self) -> Result<CheckReport> {
        let mut report = CheckReport::default();
        let pages: Vec<String> = sqlx::query_scalar(sql::check::PAGES).fetch_all(&self.pool).await?;
        report
            .problems
            .extend(pages.into_iter().filter(|line| line != "ok").map(|line| format!("database: {line}")));
        let dangling: Vec<(String, String)> =
            sqlx::query_as(sql::check::REFERENCES).fetch_all(&self.pool).await?;
        report.problems.extend(
            dangling.into_iter().map(|(child, parent)| format!("a row of {child} names no {parent}")),
        );
        let without_result: i64 =
            sqlx::query_scalar(sql::check::WITHOUT_RESULT).fetch_one(&self.pool).await?;
        if without_result > 0 {
            report.problems.push(format!("{without_result} finished work items have no result"));
        }
        let results: i64 = sqlx::query_scalar(sql::check::RESULTS).fetch_one(&self.pool).await?;
        report.results = results.unsigned_abs();
        let blobs: Vec<(String, i64)> = sqlx::query_as(sql::check::BLOBS).fetch_all(&self.pool).await?;
        for (id, bytes) in blobs {
            report.blobs += 1;
            report.bytes += bytes.unsigned_abs();
            if let Some(problem) = self.blob_problem(&id, bytes).await {
                report.problems.push(problem);
            }
        }
        Ok(report)
    }

    async fn blob_problem(&self, id: &str, bytes: i64) -> Option<String> {
        let content = match id.parse::<BlobId>() {
            Ok(id) => self.blobs().get(id).await,
            Err(error) => Err(error),
        };
        match content {
            Err(StoreError::Corrupt(problem)) => Some(problem),
            Err(error) => Some(error.to_string()),
            Ok(content) if content.len() as u64 != bytes.unsigned_abs() => {
                Some(format!("{} bytes instead of {bytes}", content.len()))
            }
            Ok(_) => None,
        }
    }
}
