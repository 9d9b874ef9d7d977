//! Extractors whose problems name the wrong field or parameter and its valid values.

use std::borrow::Cow;
use std::cell::Cell;
use std::collections::HashSet;
use std::fmt;

use axum::body::Bytes;
use axum::extract::{FromRequest, FromRequestParts, Request};
use axum::http::request::Parts;
use axum::http::{HeaderValue, header};
use bytes::BytesMut;
use drillsweep_api::problem::pointer_token;
use drillsweep_api::{LIMITS, ProblemDetails, ProblemKind, read_strictly};
use futures::StreamExt as _;
use headers::{ContentLength, HeaderMapExt as _};
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, Error as DeserializeError, MapAccess, SeqAccess, Visitor,
};
use tokio::time::timeout;

use crate::answer::error::Error;
use crate::app::App;
use crate::app::bodies::BodyMemory;
use crate::guard::caller::Caller;

/// Largest body that is parsed without a place for expansions \[bytes\].
const SMALL_BODY: usize = 64 << 10;

/// A small JSON body.
pub(crate) struct Json<T>(pub(crate) T);

/// A JSON body that may be large, unparsed; it is parsed in a place for expansions.
pub(crate) struct Body {
    /// The unparsed bytes.
    pub(crate) bytes: Bytes,
    /// Its memory, held until the work on it has ended.
    _memory: BodyMemory,
}

/// A body of any media type, of at most `MOST` bytes.
pub(crate) struct File<const MOST: usize> {
    /// The bytes.
    pub(crate) bytes: Bytes,
    /// Its memory, held until the work on it has ended.
    _memory: BodyMemory,
}

impl<T: DeserializeOwned> FromRequest<App> for Json<T> {
    type Rejection = Error;

    async fn from_request(request: Request, app: &App) -> Result<Self, Error> {
        require_json(&request)?;
        read_json(&receive(request, app, SMALL_BODY).await?.0).map(Json)
    }
}

impl FromRequest<App> for Body {
    type Rejection = Error;

    async fn from_request(request: Request, app: &App) -> Result<Self, Error> {
        require_json(&request)?;
        let (bytes, memory) = receive(request, app, LIMITS.body_bytes).await?;
        Ok(Self { bytes, _memory: memory })
    }
}

impl<const MOST: usize> FromRequest<App> for File<MOST> {
    type Rejection = Error;

    async fn from_request(request: Request, app: &App) -> Result<Self, Error> {
        let (bytes, memory) = receive(request, app, MOST).await?;
        Ok(Self { bytes, _memory: memory })
    }
}

fn require_json(request: &Request) -> Result<(), Error> {
    let media_type = request.headers().get(header::CONTENT_TYPE);
    let media_type = media_type.and_then(|value| value.to_str().ok()).unwrap_or_default();
    let essence = media_type.split(';').next().unwrap_or_default().trim();
    if !essence.eq_ignore_ascii_case("application/json") {
        let found = if essence.is_empty() { "without one" } else { essence };
        let detail = format!("the body must have Content-Type: application/json, not {found}");
        return Err(Error::new(ProblemKind::UnsupportedMediaType, detail));
    }
    Ok(())
}

/// Receives a body of at most `most` bytes; its memory grows as it arrives.
async fn receive(request: Request, app: &App, most: usize) -> Result<(Bytes, BodyMemory), Error> {
    let encoding = request.headers().get(header::CONTENT_ENCODING).map(HeaderValue::as_bytes);
    if encoding.is_some_and(|encoding| !encoding.eq_ignore_ascii_case(b"identity")) {
        let detail = "the body must have no Content-Encoding";
        return Err(Error::new(ProblemKind::UnsupportedMediaType, detail));
    }
    let too_large = || Error::new(ProblemKind::BodyTooLarge, format!("a body has at most {most} bytes"));
    // Checked before the first byte, so that a client that waits for `100 Continue` sends none.
    let length = request.headers().typed_get::<ContentLength>().map_or(0, |ContentLength(length)| length);
    if length > most as u64 {
        return Err(too_large());
    }
    let owner = request.extensions().get::<Caller>().map(Caller::budget).unwrap_or_default().to_owned();
    let mut memory = app.bodies.begin(&owner);
    let mut frames = request.into_body().into_data_stream();
    let mut bytes = BytesMut::new();
    let receiving = async {
        while let Some(frame) = frames.next().await {
            let interrupted = |_| Error::new(ProblemKind::MalformedBody, "the body was interrupted");
            let frame = frame.map_err(interrupted)?;
            if bytes.len() + frame.len() > most {
                return Err(too_large());
            }
            if !memory.grow(bytes.len() + frame.len()) {
                return Err(Error::unavailable("the memory for large bodies is in use"));
            }
            bytes.extend_from_slice(&frame);
        }
        Ok(())
    };
    let patience = app.config.connections.body;
    match timeout(patience, receiving).await {
        Ok(received) => received?,
        Err(_) => {
            let detail = format!("the body was not received within {} s", patience.as_secs_f64());
            return Err(Error::new(ProblemKind::RequestTimeout, detail));
        }
    }
    Ok((bytes.freeze(), memory))
}

/// Bound on the memory for parsing a body of `bytes` \[bytes\]: a value of a change takes 80 bytes, an object around it about 500, a listed
/// value 8.
pub(crate) fn memory_of_reading(bytes: usize) -> usize {
    const OF_VALUE: usize = 300;
    let values = (bytes / 2).min(LIMITS.values_per_request);
    let listed = (2 * bytes).min(8 * LIMITS.points_per_sweep * LIMITS.axes_per_sweep);
    values * OF_VALUE + listed
}

/// Parses JSON; errors point to the wrong member.
pub(crate) fn read_json<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Error> {
    let (mut format, mut track) =
        (serde_json::Deserializer::from_slice(bytes), serde_path_to_error::Track::new());
    let left = Cell::new(LIMITS.values_per_request);
    let count = Count { left: Some(&left), is_body: true };
    if let Err(error) = count.deserialize(serde_path_to_error::Deserializer::new(&mut format, &mut track)) {
        // Invalid JSON has no member to point to.
        let pointer = if error.is_data() { pointer(&track.path()) } else { String::new() };
        return Err(malformed(pointer, &error));
    }
    let (mut format, mut track) =
        (serde_json::Deserializer::from_slice(bytes), serde_path_to_error::Track::new());
    let value = read_strictly(serde_path_to_error::Deserializer::new(&mut format, &mut track))
        .map_err(|error| malformed(pointer(&track.path()), &error))?;
    format.end().map_err(|error| malformed(String::new(), &error))?;
    Ok(value)
}

/// Members of the body whose values are not counted, since their readers bound them.
const LISTS: [&str; 2] = ["axes", "points"];

/// Members of an object.
const MOST_MEMBERS: usize = 200;

/// Scans JSON for its number of values and for duplicate members, of which a map would silently keep the last.
#[derive(Clone, Copy)]
struct Count<'c> {
    /// Values that may still follow; `None` within a list that is not counted.
    left: Option<&'c Cell<usize>>,
    is_body: bool,
}

impl Count<'_> {
    /// Counts one value.
    fn take<E: DeserializeError>(self) -> Result<(), E> {
        let Some(left) = self.left else { return Ok(()) };
        match left.get().checked_sub(1) {
            Some(rest) => {
                left.set(rest);
                Ok(())
            }
            None => {
                let most = LIMITS.values_per_request;
                Err(E::custom(format_args!(
                    "a body has at most {most} values, not counting those of axes and points"
                )))
            }
        }
    }
}

impl<'de> DeserializeSeed<'de> for Count<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, format: D) -> Result<(), D::Error> {
        format.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Count<'_> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("JSON")
    }

    fn visit_unit<E: DeserializeError>(self) -> Result<(), E> {
        self.take()
    }

    fn visit_bool<E: DeserializeError>(self, _: bool) -> Result<(), E> {
        self.take()
    }

    fn visit_i64<E: DeserializeError>(self, _: i64) -> Result<(), E> {
        self.take()
    }

    fn visit_u64<E: DeserializeError>(self, _: u64) -> Result<(), E> {
        self.take()
    }

    fn visit_f64<E: DeserializeError>(self, _: f64) -> Result<(), E> {
        self.take()
    }

    fn visit_str<E: DeserializeError>(self, _: &str) -> Result<(), E> {
        self.take()
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        self.take()?;
        let count = Count { is_body: false, ..self };
        while entries.next_element_seed(count)?.is_some() {}
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<(), A::Error> {
        self.take()?;
        let mut names = HashSet::new();
        while let Some(name) = members.next_key::<Cow<'_, str>>()? {
            if names.len() == MOST_MEMBERS {
                return Err(A::Error::custom(format_args!("an object has at most {MOST_MEMBERS} members")));
            }
            if names.contains(&name) {
                return Err(A::Error::custom(format_args!("duplicate field `{name}`")));
            }
            let is_list = self.is_body && LISTS.contains(&name.as_ref());
            names.insert(name);
            members.next_value_seed(Count { left: self.left.filter(|_| !is_list), is_body: false })?;
        }
        Ok(())
    }
}

fn malformed(pointer: String, error: &serde_json::Error) -> Error {
    ProblemDetails::malformed_body(pointer, error).into()
}

/// A path of serde as a JSON Pointer; a variant with fields is a member.
fn pointer(path: &serde_path_to_error::Path) -> String {
    use serde_path_to_error::Segment;
    let mut pointer = String::new();
    for segment in path.iter() {
        match segment {
            Segment::Seq { index } => pointer.push_str(&format!("/{index}")),
            Segment::Map { key: member } | Segment::Enum { variant: member } => {
                pointer.push('/');
                pointer.push_str(&pointer_token(member));
            }
            Segment::Unknown => {}
        }
    }
    pointer
}

/// Query parameters; unknown ones are refused by name.
pub(crate) struct Query<T>(pub(crate) T);

impl<T: DeserializeOwned, S: Send + Sync> FromRequestParts<S> for Query<T> {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Error> {
        let query = parts.uri.query().unwrap_or_default().as_bytes();
        let deserializer = serde_urlencoded::Deserializer::new(form_urlencoded::parse(query));
        serde_path_to_error::deserialize(deserializer).map(Query).map_err(|error| {
            let name = match error.path().iter().next() {
                Some(serde_path_to_error::Segment::Map { key }) => key.clone(),
                _ => String::new(),
            };
            let got = form_urlencoded::parse(query).find(|(key, _)| *key == name).map(|(_, value)| value);
            ProblemDetails::unreadable_parameter(&name, got.as_deref(), &error.inner().to_string()).into()
        })
    }
}

/// Path parameters.
pub(crate) struct Path<T>(pub(crate) T);

impl<T: DeserializeOwned + Send, S: Send + Sync> FromRequestParts<S> for Path<T> {
    type Rejection = Error;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Error> {
        use axum::extract::path::{ErrorKind, Path as AxumPath};
        use axum::extract::rejection::PathRejection;
        match AxumPath::<T>::from_request_parts(parts, state).await {
            Ok(AxumPath(value)) => Ok(Path(value)),
            Err(PathRejection::FailedToDeserializePathParams(failure)) => Err(match failure.kind() {
                ErrorKind::ParseErrorAtKey { key, value, expected_type } => {
                    Error::parameter(key, Some(value), format!("must be {}", describe(expected_type)))
                }
                ErrorKind::DeserializeError { key, value, message } => {
                    Error::parameter(key, Some(value), message)
                }
                kind => Error::parameter("path", None, kind.to_string()),
            }),
            Err(rejection) => Err(Error::internal(&rejection)),
        }
    }
}

fn describe(expected_type: &str) -> &str {
    match expected_type {
        "u32" | "u64" => "a whole number",
        other => other,
    }
}

/// Parsers of query values, whose messages state the valid values.
pub(crate) mod value {
    use std::time::Duration;

    use drillsweep_api::axis::{Axis, Scale};
    use drillsweep_api::judgement::LimitChanges;
    use drillsweep_api::time_span;
    use drillsweep_quantity::{Name, UnitChoice, entry};
    use serde::{Deserialize, Deserializer, de::Error};

    /// A finite number.
    pub(crate) fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
        let text = String::deserialize(deserializer)?;
        match text.parse() {
            Ok(number) if f64::is_finite(number) => Ok(Some(number)),
            _ => Err(D::Error::custom("must be a number")),
        }
    }

    /// Numbers as `a,b,c` or `from:to:count`.
    pub(crate) fn list<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
        let text = String::deserialize(deserializer)?;
        let refused = || {
            D::Error::custom(
                "must be numbers separated by commas, or FROM:TO:COUNT with a count of 2 to 1000",
            )
        };
        let number = |text: &str| {
            text.trim().parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(refused)
        };
        match text.split(':').collect::<Vec<_>>()[..] {
            [list] => list.split(',').map(number).collect(),
            [from, to, count] => {
                let count = count.trim().parse::<u32>().ok().filter(|count| (2..=1000).contains(count));
                let count = count.ok_or_else(refused)?;
                let axis = Axis::Range { from: number(from)?, to: number(to)?, count, scale: Scale::Linear };
                Ok((0..count as usize).map(|i| axis.value(i)).collect())
            }
            _ => Err(refused()),
        }
    }

    /// A whole number from 1, of format `int32` in the OpenAPI document.
    pub(crate) fn count<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u32>, D::Error> {
        let text = String::deserialize(deserializer)?;
        match text.parse() {
            Ok(number) if (1..=i32::MAX as u32).contains(&number) => Ok(Some(number)),
            _ => Err(D::Error::custom("must be a whole number of 1 or more, 2147483647 at most")),
        }
    }

    /// A whole number.
    pub(crate) fn whole<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u64>, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map(Some).map_err(|_| D::Error::custom("must be a whole number"))
    }

    /// Names separated by commas.
    pub(crate) fn names<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Vec<String>>, D::Error> {
        let text = String::deserialize(deserializer)?;
        Ok(Some(text.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()))
    }

    /// Names with a finite number each, which may have a unit, separated by commas: `flow_rate:0.01,mud_density:10 ppg`.
    pub(crate) fn assignments<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Vec<(String, f64)>>, D::Error> {
        let assignment = |text: String| {
            let (name, number) = text.rsplit_once(':')?;
            let (name, number) = (name.trim(), number.trim());
            let with_unit = || entry::read(number, Name::parse(name)?.units()?).ok();
            let number = number.parse().ok().or_else(with_unit)?;
            f64::is_finite(number).then(|| (name.to_owned(), number))
        };
        let assignments: Option<Vec<_>> =
            names(deserializer)?.unwrap_or_default().into_iter().map(assignment).collect();
        match assignments {
            Some(assignments) => Ok(Some(assignments)),
            None => Err(D::Error::custom("must be names with a number each, such as mud.density:1200")),
        }
    }

    /// Units of columns: a system, and `COLUMN:UNIT`, separated by commas.
    pub(crate) fn units<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<UnitChoice>, D::Error> {
        let text = String::deserialize(deserializer)?;
        UnitChoice::parse(&text).map(Some).map_err(|error| D::Error::custom(format_args!("must be {error}")))
    }

    /// Changes of limits: `COLUMN:VALUE` or `COLUMN:off`, separated by commas.
    pub(crate) fn limits<'de, D: Deserializer<'de>>(deserializer: D) -> Result<LimitChanges, D::Error> {
        let text = String::deserialize(deserializer)?;
        LimitChanges::parse(&text).map_err(D::Error::custom)
    }

    /// `true` or `false`.
    pub(crate) fn truth<'de, D: Deserializer<'de>>(deserializer: D) -> Result<bool, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(|_| D::Error::custom("must be true or false"))
    }

    /// `true` or `false`, or absent.
    pub(crate) fn choice<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<bool>, D::Error> {
        truth(deserializer).map(Some)
    }

    /// A time span: `30s`, `500ms` or, in seconds, `30`.
    pub(crate) fn span<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Duration>, D::Error> {
        let text = String::deserialize(deserializer)?;
        time_span::parse(&text).map(Some).map_err(D::Error::custom)
    }
}

/// Entries in a page: the requested number, or 50.
pub(crate) fn page_size(limit: Option<u32>) -> Result<u32, Error> {
    match limit {
        None => Ok(DEFAULT_PAGE_SIZE),
        Some(limit) if limit <= LIMITS.page_size => Ok(limit),
        Some(limit) => {
            let detail = format!("must be at most {}", LIMITS.page_size);
            Err(Error::parameter("limit", Some(&limit.to_string()), detail))
        }
    }
}

const DEFAULT_PAGE_SIZE: u32 = 50;
