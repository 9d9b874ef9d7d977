//! Verification of the store: the database's own checks, and every blob against its name.

use crate::blob_id::BlobId;
use crate::engine::query::query;
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;
use crate::work::state::{WorkKey, work_key};

/// Extent of a check, and the problems that it found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CheckReport {
    /// Results looked at.
    pub results: u64,
    /// Blobs read, each once however many results name it.
    pub blobs: u64,
    /// Their size.
    pub bytes: u64,
    /// Problems, one text each; empty if all is well.
    pub problems: Vec<String>,
    /// Blobs among these problems that are lost, by their names.
    pub damaged: Vec<String>,
    /// Work items that are done and have no result.
    pub without_result: Vec<WorkKey>,
}

impl Store {
    /// Reads everything and compares: pages and references of the database, finished work against results, sizes and hashes of the blobs
    /// that results name. Changes nothing; the service may run at the same time. [`repair`](Self::repair) queues the losses that it finds.
    ///
    /// # Errors
    /// The database cannot be read. Contents that can be read but are wrong are reported, and are no error.
    pub async fn check(&self) -> Result<CheckReport> {
        let mut report = CheckReport::default();
        let pages: Vec<String> = query(sql::check::PAGES).scalars(&self.database).await?;
        report
            .problems
            .extend(pages.into_iter().filter(|line| line != "ok").map(|line| format!("database: {line}")));
        let dangling: Vec<(String, String)> = query(sql::check::REFERENCES).rows(&self.database).await?;
        report.problems.extend(
            dangling.into_iter().map(|(child, parent)| format!("a row of {child} names no {parent}")),
        );
        let without_result: Vec<Vec<u8>> = query(sql::check::WITHOUT_RESULT).scalars(&self.database).await?;
        report.without_result = without_result.iter().map(|key| work_key(key)).collect::<Result<_>>()?;
        if !without_result.is_empty() {
            report.problems.push(format!("{} finished work items have no result", without_result.len()));
        }
        let results: i64 = query(sql::check::RESULTS).scalar(&self.database).await?;
        report.results = results.unsigned_abs();
        let blobs: Vec<(String, i64)> = query(sql::check::BLOBS).rows(&self.database).await?;
        for (id, bytes) in blobs {
            report.blobs += 1;
            report.bytes += bytes.unsigned_abs();
            match self.verify_blob(&id).await {
                Ok(size) if size == bytes.unsigned_abs() => {}
                Ok(size) => report.problems.push(format!("blob {id}: {size} bytes instead of {bytes}")),
                // The others cannot be verified either.
                Err(error) if error.is_unavailable() => return Err(error),
                Err(error) => {
                    report.problems.push(error.to_string());
                    if error.is_damage() {
                        report.damaged.push(id);
                    }
                }
            }
        }
        Ok(report)
    }

    async fn verify_blob(&self, id: &str) -> Result<u64> {
        self.blobs().verify(id.parse::<BlobId>()?).await
    }
}
