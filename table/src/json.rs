//! Tables as JSON: an object of columns, as serde writes [`Table`](crate::Table), a few columns at a time.

use serde::Serialize;

use crate::error::TableError;
use crate::source::{Sink, Source};

/// The table as serde writes it, to the byte; it holds one piece of some columns in memory.
///
/// # Errors
/// A piece cannot be read, or the sink fails.
pub fn write_to(source: &impl Source, sink: &mut Sink<'_>) -> Result<(), TableError> {
    let layout = source.layout();
    sink.write_all(b"{")?;
    if !layout.attributes.is_empty() {
        sink.write_all(b"\"attributes\":")?;
        put(sink, &layout.attributes)?;
        sink.write_all(b",")?;
    }
    sink.write_all(b"\"columns\":{")?;
    let mut is_first = true;
    for piece in source.by_columns() {
        for (name, column) in &piece?.columns {
            if !is_first {
                sink.write_all(b",")?;
            }
            is_first = false;
            put(sink, name)?;
            sink.write_all(b":")?;
            put(sink, column)?;
        }
    }
    sink.write_all(b"},\"units\":")?;
    put(sink, &layout.units)?;
    Ok(sink.write_all(b"}")?)
}

fn put(sink: &mut Sink<'_>, value: &(impl Serialize + ?Sized)) -> Result<(), TableError> {
    serde_json::to_writer(sink, value).map_err(|error| std::io::Error::from(error).into())
}
