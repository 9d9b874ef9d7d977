//! Memory that answers need.

use crate::answer::blocking::blocking;
use crate::answer::error::Result;
use crate::answer::format::{self, Format};
use crate::answer::stored::Stored;

/// Length of a file from which writing it in another format takes seconds \[bytes\].
const LONG: u64 = 1 << 20;

/// Memory for a view of a result.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Need {
    /// Memory without that of the body while it is sent \[bytes\].
    pub(crate) bytes: u64,
    /// True if the memory is held for long, as by a long table on a slow line; answers that need little do not wait for it.
    pub(crate) is_long: bool,
}

impl From<u64> for Need {
    fn from(bytes: u64) -> Self {
        Need { bytes, is_long: false }
    }
}

impl Need {
    /// Memory for writing a stored table, or some of its columns; CSV is written some rows at a time.
    pub(crate) async fn of(stored: &Stored, format: Format, columns: Option<&[String]>) -> Result<Self> {
        if format != Format::Csv {
            return Ok(format.memory(stored.memory().await?).into());
        }
        let is_long = stored.length() > LONG;
        let (stored, columns) = (stored.clone(), columns.map(<[String]>::to_vec));
        blocking(move || {
            let table = stored.open()?;
            let layout = format::select(table.layout().clone(), columns.as_deref())?;
            Ok(Need { bytes: table.memory_by_rows(&layout), is_long })
        })
        .await
    }
}
