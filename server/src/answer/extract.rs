//! Extractors that answer with problems naming what is wrong: the field, the parameter, what would be valid.

use std::collections::HashSet;
use std::fmt;
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::{FromRef, FromRequest, FromRequestParts, Request};
use axum::http::request::Parts;
use axum::http::{HeaderValue, StatusCode, header};
use drillsweep_api::problem::pointer_token;
use drillsweep_api::{LIMITS, ProblemDetails, ProblemKind, read_strictly};
use serde::de::{Deserialize, DeserializeOwned, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::Value;
use tokio::time::timeout;

use crate::answer::error::Error;

/// A JSON body, together with the bytes that came in.
pub(crate) struct Json<T> {
    /// The body.
    pub(crate) value: T,
    /// As it was sent.
    pub(crate) bytes: Bytes,
}

/// How long a body may take to come.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyPatience(pub(crate) Duration);

impl<T, S> FromRequest<S> for Json<T>
where
    T: DeserializeOwned,
    S: Send + Sync,
    BodyPatience: FromRef<S>,
{
    type Rejection = Error;

    async fn from_request(request: Request, state: &S) -> Result<Self, Error> {
        let media_type = request.headers().get(header::CONTENT_TYPE);
        let media_type = media_type.and_then(|value| value.to_str().ok()).unwrap_or_default();
        let essence = media_type.split(';').next().unwrap_or_default().trim();
        if !essence.eq_ignore_ascii_case("application/json") {
            let found = if essence.is_empty() { "without one" } else { essence };
            let detail = format!("the body must come with Content-Type: application/json, not {found}");
            return Err(Error::new(ProblemKind::UnsupportedMediaType, detail));
        }
        let encoding = request.headers().get(header::CONTENT_ENCODING).map(HeaderValue::as_bytes);
        if encoding.is_some_and(|encoding| !encoding.eq_ignore_ascii_case(b"identity")) {
            let detail = "the body must be sent as it is, without Content-Encoding";
            return Err(Error::new(ProblemKind::UnsupportedMediaType, detail));
        }
        let BodyPatience(patience) = FromRef::from_ref(state);
        let Ok(bytes) = timeout(patience, Bytes::from_request(request, state)).await else {
            let detail = format!("the body did not come within {} s", patience.as_secs_f64());
            return Err(Error::new(ProblemKind::RequestTimeout, detail));
        };
        let bytes = bytes.map_err(|rejection| {
            if rejection.status() == StatusCode::PAYLOAD_TOO_LARGE {
                let detail = format!("a body has at most {} bytes", LIMITS.body_bytes);
                Error::new(ProblemKind::BodyTooLarge, detail)
            } else {
                Error::new(ProblemKind::MalformedBody, "the body was interrupted")
            }
        })?;
        let value = parse(&bytes)?;
        Ok(Json { value, bytes })
    }
}

fn parse<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Error> {
    let mut text = serde_json::Deserializer::from_slice(bytes);
    if let Err(error) = serde_path_to_error::deserialize::<_, Unrepeated>(&mut text) {
        let is_repeated = error.inner().is_data();
        let pointer = if is_repeated { pointer(error.path()) } else { String::new() };
        return Err(malformed(pointer, error.inner()));
    }
    read(bytes).or_else(|_| {
        // Seen as JSON first, so that a value of another type is told from a text that is no JSON.
        let mut body = serde_json::from_slice(bytes).map_err(|error| malformed(String::new(), &error))?;
        write_whole(&mut body);
        read(&serde_json::to_vec(&body).map_err(|error| Error::internal(&error))?)
    })
}

/// A type out of JSON, with the place of what is wrong. All bodies are read here: a second reader would be compiled for each of their types.
fn read<T: DeserializeOwned>(text: &[u8]) -> Result<T, Error> {
    let (mut format, mut track) =
        (serde_json::Deserializer::from_slice(text), serde_path_to_error::Track::new());
    let value = read_strictly(serde_path_to_error::Deserializer::new(&mut format, &mut track))
        .map_err(|error| malformed(pointer(&track.path()), &error))?;
    format.end().map_err(|error| malformed(String::new(), &error))?;
    Ok(value)
}

/// JSON in which no object has a member twice: maps would take the last, and the client could have meant the other.
struct Unrepeated;

impl<'de> Deserialize<'de> for Unrepeated {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Unrepeated)
    }
}

impl<'de> Visitor<'de> for Unrepeated {
    type Value = Self;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("JSON")
    }

    fn visit_unit<E>(self) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_bool<E>(self, _: bool) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_str<E>(self, _: &str) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Self, A::Error> {
        while entries.next_element::<Self>()?.is_some() {}
        Ok(self)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Self, A::Error> {
        let mut names = HashSet::new();
        while let Some(name) = members.next_key::<String>()? {
            if names.contains(&name) {
                return Err(A::Error::custom(format_args!("duplicate field `{name}`")));
            }
            names.insert(name);
            members.next_value::<Self>()?;
        }
        Ok(self)
    }
}

/// Writes whole numbers without a decimal point: to JSON Schema 2.0 is an integer, and some clients write integers so.
fn write_whole(body: &mut Value) {
    /// Beyond it a float does not hold every integer.
    const LARGEST: f64 = (1_u64 << 53) as f64;
    match body {
        Value::Array(entries) => entries.iter_mut().for_each(write_whole),
        Value::Object(members) => members.values_mut().for_each(write_whole),
        Value::Number(number) => {
            let whole = number.as_f64().filter(|value| value.fract() == 0.0 && value.abs() <= LARGEST);
            if let Some(whole) = whole.filter(|_| number.is_f64()) {
                *body = Value::from(whole as i64);
            }
        }
        _ => {}
    }
}

fn malformed(pointer: String, error: &serde_json::Error) -> Error {
    ProblemDetails::malformed_body(pointer, error).into()
}

/// A path of serde's as a JSON Pointer. A variant that has fields is a member that holds them.
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

/// Query parameters; an unknown one is refused by name.
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

/// Query values by what they are, with messages that say what would be valid.
pub(crate) mod value {
    use std::time::Duration;

    use drillsweep_api::time_span;
    use serde::{Deserialize, Deserializer, de::Error};

    /// A finite number.
    pub(crate) fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
        let text = String::deserialize(deserializer)?;
        match text.parse() {
            Ok(number) if f64::is_finite(number) => Ok(Some(number)),
            _ => Err(D::Error::custom("must be a number")),
        }
    }

    /// A whole number of 1 or more, which the document's format `int32` has.
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

    /// Names with a finite number each, separated by commas: `flow_rate:0.01,mud_density:1200`.
    pub(crate) fn assignments<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Vec<(String, f64)>>, D::Error> {
        let assignment = |text: String| {
            let (name, number) = text.rsplit_once(':')?;
            let number: f64 = number.trim().parse().ok()?;
            number.is_finite().then(|| (name.trim().to_owned(), number))
        };
        let assignments: Option<Vec<_>> =
            names(deserializer)?.unwrap_or_default().into_iter().map(assignment).collect();
        match assignments {
            Some(assignments) => Ok(Some(assignments)),
            None => Err(D::Error::custom("must be names with a number each, such as mud.density:1200")),
        }
    }

    /// `true` or `false`.
    pub(crate) fn truth<'de, D: Deserializer<'de>>(deserializer: D) -> Result<bool, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(|_| D::Error::custom("must be true or false"))
    }

    /// `true` or `false` where either is a choice of its own.
    pub(crate) fn choice<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<bool>, D::Error> {
        truth(deserializer).map(Some)
    }

    /// A time span: `30s`, `500ms` or, in seconds, `30`.
    pub(crate) fn span<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Duration>, D::Error> {
        let text = String::deserialize(deserializer)?;
        time_span::parse(&text).map(Some).map_err(D::Error::custom)
    }
}

/// The number of entries in a page: as asked for, else 50.
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
