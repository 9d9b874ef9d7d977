//! Tables and reports of a result as files that are ready to be stored.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use drillsweep_table::{Table, TableError, parquet};
use serde_json::Value;

/// A table or report as it is stored.
#[derive(Debug)]
pub struct EncodedArtifact {
    /// Its name within the result.
    pub name: &'static str,
    /// Its media type.
    pub media_type: &'static str,
    /// Number of rows.
    pub row_count: usize,
    /// Its content, in a file without a name.
    pub file: File,
}

const JSON: &str = "application/json";
const PARQUET: &str = "application/vnd.apache.parquet";

/// Errors of keeping samples and tables.
#[derive(Debug, thiserror::Error)]
pub enum ArtifactError {
    /// A table cannot be encoded.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A file in the directory for temporary files cannot be written or read.
    #[error("a temporary file cannot be used: {0}")]
    Scratch(#[from] std::io::Error),
}

impl EncodedArtifact {
    /// Name of the file that it is kept as.
    pub fn file_name(&self) -> String {
        let extension = if self.media_type == JSON { "json" } else { "parquet" };
        format!("{}.{extension}", self.name)
    }

    /// A table.
    pub(crate) fn table(name: &'static str, table: &Table, scratch: &Path) -> Result<Self, ArtifactError> {
        Self::pieces(name, table, scratch, std::iter::once(Ok(table)))
    }

    /// A table that comes in pieces with the columns of `layout`.
    pub(crate) fn pieces<T: std::borrow::Borrow<Table>>(
        name: &'static str,
        layout: &Table,
        scratch: &Path,
        pieces: impl Iterator<Item = std::io::Result<T>>,
    ) -> Result<Self, ArtifactError> {
        let mut row_count = 0;
        let mut file = BufWriter::new(tempfile::tempfile_in(scratch)?);
        let mut writer = parquet::Writer::new(&mut file, layout)?;
        for piece in pieces {
            let piece = piece?;
            row_count += piece.borrow().rows();
            writer.write(piece.borrow())?;
        }
        writer.finish()?;
        let file = file.into_inner().map_err(std::io::IntoInnerError::into_error)?;
        Ok(Self { name, media_type: PARQUET, row_count, file })
    }

    /// A report.
    pub(crate) fn report(
        name: &'static str,
        report: &Value,
        row_count: usize,
        scratch: &Path,
    ) -> Result<Self, ArtifactError> {
        let mut file = tempfile::tempfile_in(scratch)?;
        file.write_all(report.to_string().as_bytes())?;
        Ok(Self { name, media_type: JSON, row_count, file })
    }
}
