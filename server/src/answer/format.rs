//! Forms of tables, format and units: choice and writing.

use std::io;

use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use drillsweep_api::{ProblemDetails, ProblemKind};
use drillsweep_chart::{ChartError, Drawing, PNG_WIDTH};
use drillsweep_quantity::UnitChoice;
use drillsweep_table::parquet::Cut;
use drillsweep_table::{InUnits, Sink, Source, Table, TableError, csv, json, npz, parquet};
use serde::Deserialize;

use crate::answer::error::{Error, Result};
use crate::answer::etag::Tag;
use crate::answer::stored::{Stored, StoredFile};

/// Formats in which tables are served.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum TableFormat {
    /// An object of columns.
    Json,
    /// One line a row, after a line of column names; a missing value is empty.
    Csv,
    /// Apache Parquet.
    Parquet,
    /// NumPy's archive of arrays.
    Npz,
}

/// Formats of tables that can also be drawn as pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PictureFormat {
    /// An object of columns.
    Json,
    /// One line a row, after a line of column names; a missing value is empty.
    Csv,
    /// Apache Parquet.
    Parquet,
    /// NumPy's archive of arrays.
    Npz,
    /// A picture as SVG.
    Svg,
    /// A picture as PNG.
    Png,
}

/// A format to serve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Json,
    Csv,
    Parquet,
    Npz,
    Svg,
    Png,
}

/// Format that a query may request.
pub(crate) trait RequestedFormat: Into<Format> {
    /// All formats that the query may request; on a tie of `Accept` the first one wins.
    const OFFERED: &'static [Format];
}

impl RequestedFormat for TableFormat {
    const OFFERED: &'static [Format] = &[Format::Json, Format::Csv, Format::Parquet, Format::Npz];
}

impl RequestedFormat for PictureFormat {
    const OFFERED: &'static [Format] =
        &[Format::Json, Format::Csv, Format::Parquet, Format::Npz, Format::Svg, Format::Png];
}

impl From<TableFormat> for Format {
    fn from(format: TableFormat) -> Self {
        match format {
            TableFormat::Json => Format::Json,
            TableFormat::Csv => Format::Csv,
            TableFormat::Parquet => Format::Parquet,
            TableFormat::Npz => Format::Npz,
        }
    }
}

impl From<PictureFormat> for Format {
    fn from(format: PictureFormat) -> Self {
        match format {
            PictureFormat::Json => Format::Json,
            PictureFormat::Csv => Format::Csv,
            PictureFormat::Parquet => Format::Parquet,
            PictureFormat::Npz => Format::Npz,
            PictureFormat::Svg => Format::Svg,
            PictureFormat::Png => Format::Png,
        }
    }
}

impl Format {
    /// Media type of the format.
    pub(crate) fn media_type(self) -> &'static str {
        match self {
            Format::Json => "application/json",
            Format::Csv => "text/csv",
            Format::Parquet => "application/vnd.apache.parquet",
            Format::Npz => "application/x-npz",
            Format::Svg => "image/svg+xml",
            Format::Png => "image/png",
        }
    }

    fn extension(self) -> &'static str {
        match self {
            Format::Json => "json",
            Format::Csv => "csv",
            Format::Parquet => "parquet",
            Format::Npz => "npz",
            Format::Svg => "svg",
            Format::Png => "png",
        }
    }

    /// Memory for writing a table in this format \[bytes\], from that for reading it. The footer of Parquet, with its statistics, is larger
    /// in writing.
    pub(crate) fn memory(self, reading: u64) -> u64 {
        if self == Format::Parquet { 3 * reading + parquet::MEMORY_OF_WRITER } else { reading }
    }

    pub(crate) fn is_picture(self) -> bool {
        matches!(self, Format::Svg | Format::Png)
    }

    /// The format to serve: `?format=` if given, else the best that `Accept` allows, else JSON.
    fn choose<A: RequestedFormat>(asked: Option<A>, headers: &HeaderMap) -> Result<Format> {
        if let Some(format) = asked {
            return Ok(format.into());
        }
        let accepted: Vec<&str> =
            headers.get_all(header::ACCEPT).iter().filter_map(|value| value.to_str().ok()).collect();
        if accepted.is_empty() {
            return Ok(Format::Json);
        }
        let accepted = accepted.join(",");
        best(&accepted, A::OFFERED).ok_or_else(|| {
            let offered: Vec<_> = A::OFFERED.iter().map(|format| format.media_type()).collect();
            let detail = format!("this is served as {}, not as {accepted}", offered.join(", "));
            Error::new(ProblemKind::NotAcceptable, detail)
        })
    }
}

/// Form of an answer: its format, and the units of its columns. Tags and names of files depend on both.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Form {
    pub(crate) format: Format,
    pub(crate) units: UnitChoice,
}

impl From<Format> for Form {
    fn from(format: Format) -> Self {
        Form { format, units: UnitChoice::default() }
    }
}

impl Form {
    /// The form to serve: the format as of [`Format::choose`], and the requested units, or those in which columns are kept.
    pub(crate) fn choose<A: RequestedFormat>(
        format: Option<A>,
        units: Option<UnitChoice>,
        headers: &HeaderMap,
    ) -> Result<Self> {
        Ok(Form { format: Format::choose(format, headers)?, units: units.unwrap_or_default() })
    }

    /// True if stored Parquet has this form.
    pub(crate) fn is_stored(&self) -> bool {
        self.format == Format::Parquet && self.units.is_kept()
    }

    /// Name of a file of this form.
    fn file_name(&self, name: &str) -> String {
        let extension = self.format.extension();
        match self.units.suffix() {
            Some(suffix) => format!("{name}-{suffix}.{extension}"),
            None => format!("{name}.{extension}"),
        }
    }

    fn write(&self, source: &impl Source, sink: &mut Sink<'_>) -> Result<(), TableError> {
        match self.format {
            Format::Json => json::write_to(source, sink),
            Format::Csv if self.units.is_kept() => csv::write_to(source, sink),
            Format::Csv => csv::write_with_units(source, sink),
            Format::Parquet => parquet::write_to(source, sink),
            Format::Npz => npz::write_to(source, sink),
            Format::Svg | Format::Png => {
                Err(io::Error::new(io::ErrorKind::Unsupported, "a table is no picture").into())
            }
        }
    }
}

/// The format with the greatest weight in an `Accept` header (RFC 9110 section 12.5.1); on a tie, the one
/// that is offered first. A media range that is more specific overrides one that is less.
fn best(accept: &str, offered: &[Format]) -> Option<Format> {
    let weight = |format: Format| {
        let media_type = format.media_type();
        let family = media_type.split('/').next().unwrap_or_default();
        accept
            .split(',')
            .filter_map(|range| {
                let mut parts = range.split(';').map(str::trim);
                let range = parts.next()?.to_ascii_lowercase();
                let specificity = match range.split_once('/')? {
                    ("*", "*") => 0,
                    (of_family, "*") if of_family == family => 1,
                    _ if range == media_type => 2,
                    _ => return None,
                };
                let weight =
                    parts.find_map(|part| part.strip_prefix("q=")).map_or(Some(1.0), |q| q.parse().ok())?;
                Some((specificity, weight))
            })
            .max_by_key(|(specificity, _)| *specificity)
            .map_or(0.0_f64, |(_, weight)| weight)
    };
    let mut chosen = None;
    let mut greatest = 0.0;
    for format in offered {
        if weight(*format) > greatest {
            (chosen, greatest) = (Some(*format), weight(*format));
        }
    }
    chosen
}

/// A table or picture to serve, with a file name.
pub(crate) struct Answer {
    head: Head,
    content: Content,
}

enum Content {
    Table(Table),
    Part(Box<(Stored, Cut<StoredFile>)>),
    Picture(Vec<u8>),
}

impl Answer {
    /// A table in memory in its kept units, or its columns `fields`, in a form other than a picture. Without a known tag, its contents are hashed, which
    /// takes as long as writing them.
    pub(crate) fn of_table(
        table: Table,
        fields: Option<&[String]>,
        form: Form,
        name: &str,
        tag: Option<Tag>,
    ) -> Result<Self> {
        let table = select(table, fields)?.in_units(&form.units);
        let tag = match tag {
            Some(tag) => tag,
            None => {
                let mut hasher = blake3::Hasher::new();
                form.write(&table, &mut hasher)?;
                Tag::of_hash(&hasher.finalize())
            }
        };
        Ok(Self { head: Head::new(form, name, tag), content: Content::Table(table) })
    }

    /// A table in memory, or a picture that `draw` makes from all of it.
    pub(crate) fn of_table_or_picture(
        table: Table,
        fields: Option<&[String]>,
        form: Form,
        name: &str,
        tag: Option<Tag>,
        draw: impl FnOnce(&Table, &UnitChoice) -> Result<Drawing, ChartError>,
    ) -> Result<Self> {
        let picture = match form.format {
            Format::Svg => draw(&table, &form.units)?.svg().into_bytes(),
            Format::Png => {
                draw(&table, &form.units)?.png(PNG_WIDTH).map_err(|error| Error::internal(&error))?
            }
            _ => return Self::of_table(table, fields, form, name, tag),
        };
        let tag = tag.unwrap_or_else(|| Tag::of_hash(&blake3::hash(&picture)));
        Ok(Self { head: Head::new(form, name, tag), content: Content::Picture(picture) })
    }

    /// A part of a stored table, in a form other than a picture.
    pub(crate) fn of_part(stored: Stored, part: Cut<StoredFile>, form: Form, name: &str, tag: Tag) -> Self {
        Self { head: Head::new(form, name, tag), content: Content::Part(Box::new((stored, part))) }
    }

    /// Head and body of a picture.
    ///
    /// # Errors
    /// The answer is a table.
    pub(crate) fn into_picture(self) -> Result<(Head, Bytes)> {
        match self.content {
            Content::Picture(bytes) => Ok((self.head, bytes.into())),
            Content::Table(_) | Content::Part(_) => Err(Error::internal("a table was drawn as no picture")),
        }
    }

    /// A picture of these bytes, for tests of the cache of pictures.
    #[cfg(test)]
    pub(crate) fn of_bytes(bytes: &str) -> Self {
        let head = Head::new(Format::Svg.into(), "test", Tag::of(Format::Svg, &bytes));
        Self { head, content: Content::Picture(bytes.as_bytes().to_vec()) }
    }

    /// Head of the body.
    pub(crate) fn head(&self) -> Head {
        self.head.clone()
    }

    /// Writes the body.
    pub(crate) fn write(&self, sink: &mut Sink<'_>) -> Result<(), TableError> {
        match &self.content {
            Content::Table(table) => self.head.form.write(table, sink),
            Content::Part(part) if self.head.form.units.is_kept() => self.head.form.write(&part.1, sink),
            Content::Part(part) => self.head.form.write(&InUnits::new(&part.1, &self.head.form.units), sink),
            Content::Picture(bytes) => Ok(sink.write_all(bytes)?),
        }
    }

    /// Problem of a body that could not be written.
    pub(crate) fn problem(&self, error: TableError) -> Error {
        match &self.content {
            Content::Part(part) => part.0.problem(error),
            _ => error.into(),
        }
    }
}

/// The requested columns of a table.
pub(crate) fn select(table: Table, fields: Option<&[String]>) -> Result<Table> {
    let Some(fields) = fields else { return Ok(table) };
    let selected = table.select(fields);
    Ok(selected.map_err(|missing| Box::new(ProblemDetails::no_such_column(&table, &missing)))?)
}

/// Head of a body: form, file name, and tag.
#[derive(Debug, Clone)]
pub(crate) struct Head {
    form: Form,
    name: String,
    tag: Tag,
}

impl Head {
    pub(crate) fn new(form: Form, name: &str, tag: Tag) -> Self {
        Self { form, name: name.to_owned(), tag }
    }

    /// The response with this body.
    pub(crate) fn response(self, body: Body) -> Response {
        let mut response = self.tag.on(body.into_response());
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(self.form.format.media_type()));
        let disposition = format!("inline; filename=\"{}\"", self.form.file_name(&self.name));
        if let Ok(disposition) = disposition.parse() {
            headers.insert(header::CONTENT_DISPOSITION, disposition);
        }
        response
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_specific_range_gives_the_weight() {
        for (accept, format) in [
            ("*/*", Some(Format::Json)),
            ("text/csv", Some(Format::Csv)),
            ("text/*", Some(Format::Csv)),
            ("text/csv;q=0.5, application/json", Some(Format::Json)),
            ("application/json;q=0.1, text/csv;q=0.5, */*;q=0.2", Some(Format::Csv)),
            ("application/json;q=0, */*", Some(Format::Csv)),
            ("APPLICATION/VND.APACHE.PARQUET", Some(Format::Parquet)),
            ("image/png", None),
            ("application/json;q=0", None),
            ("application/x-npz", Some(Format::Npz)),
        ] {
            assert_eq!(best(accept, TableFormat::OFFERED), format, "{accept}");
        }
        assert_eq!(best("image/*", PictureFormat::OFFERED), Some(Format::Svg));
    }
}
