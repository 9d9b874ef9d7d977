//! Memory that answers need.

use crate::answer::blocking::blocking;
use crate::answer::error::Result;
use crate::answer::format::{self, Format};
use crate::answer::stored::Stored;

/// Length of a file \[bytes\] from which on writing it in another format takes seconds.
const LONG: u64 = 1 << 20;

/// Memory that a view of a result needs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Need {
    /// Bytes, but for the body on its way.
    pub(crate) bytes: u64,
    /// Held for long, as by a client that takes a long table slowly: answers that need little do not wait for it.
    pub(crate) is_long: bool,
}

impl From<u64> for Need {
    fn from(bytes: u64) -> Self {
        Need { bytes, is_long: false }
    }
}

impl Need {
    /// Memory for writing some columns of a stored table, or all of them, in a format: as CSV some rows at a time.
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
