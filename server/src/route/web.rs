//! The web page and the pages of the OpenAPI document: files of `server/web/`, embedded in the program.

use std::collections::BTreeMap;
use std::io::{self, Read as _};
use std::sync::{LazyLock, OnceLock};

use axum::http::{HeaderMap, HeaderValue, Uri, header};
use axum::response::{IntoResponse, Response};
use bytes::Bytes;
use drillsweep_api::ProblemKind;
use flate2::read::GzDecoder;

use crate::answer::error::{Error, Result};
use crate::answer::extract::Path;
use crate::guard::middleware;

/// Path, hash, compressed bytes and imports of each file.
const FILES: &[(&str, &str, &[u8], &[&str])] = include!(concat!(env!("OUT_DIR"), "/web.rs"));

/// Content security policy of the page, which loads from this service alone. The page and Swagger UI set inline styles; pictures to be saved,
/// and Swagger UI's icons, are data.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; \
    img-src 'self' data:; font-src 'self'; connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'self'";

/// Version of all files together, which is part of their paths, so that browsers can keep them without limit.
static VERSION: LazyLock<String> = LazyLock::new(|| {
    let mut hasher = blake3::Hasher::new();
    for (path, hash, ..) in FILES {
        hasher.update(path.as_bytes()).update(hash.as_bytes());
    }
    hasher.finalize().to_hex()[..16].to_owned()
});

/// A compressed file, and its contents once they were requested.
struct File {
    compressed: &'static [u8],
    plain: OnceLock<Bytes>,
}

static BY_PATH: LazyLock<BTreeMap<&str, File>> = LazyLock::new(|| {
    let file = |compressed| File { compressed, plain: OnceLock::new() };
    FILES.iter().map(|(path, _, bytes, _)| (*path, file(*bytes))).collect()
});

/// The web page.
pub(crate) async fn page(uri: Uri) -> Result<Response> {
    static PAGE: LazyLock<io::Result<String>> =
        LazyLock::new(|| Ok(html("index.html")?.replace("</title>\n", &format!("</title>\n{}", imports()?))));
    html_response(&PAGE, &uri)
}

/// Pages of the OpenAPI document.
pub(crate) async fn documentation(uri: Uri) -> Result<Response> {
    static PAGE: LazyLock<io::Result<String>> = LazyLock::new(|| html("docs.html"));
    html_response(&PAGE, &uri)
}

/// A page with the paths of this version; empty if it does not exist.
fn html(path: &str) -> io::Result<String> {
    let text = BY_PATH.get(path).map(File::plain).transpose()?.unwrap_or_default();
    Ok(str::from_utf8(&text).map_err(io::Error::other)?.replace("\"web/", &format!("\"/web/{}/", *VERSION)))
}

fn html_response(page: &'static io::Result<String>, uri: &Uri) -> Result<Response> {
    let text = page.as_ref().map_err(Error::internal)?;
    if text.is_empty() {
        return Err(missing(uri));
    }
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8")),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
        (header::ETAG, tag(uri.path())?),
    ];
    Ok((headers, usual(), text.as_str()).into_response())
}

/// Imports of each module, as JSON: the page loads those of a view at once, which a browser would find one after the other.
fn imports() -> io::Result<String> {
    let imports = FILES.iter().filter(|(.., imported)| !imported.is_empty());
    let imports: BTreeMap<&str, &[&str]> = imports.map(|(path, .., imported)| (*path, *imported)).collect();
    let imports = serde_json::to_string(&imports).map_err(io::Error::other)?;
    Ok(format!("  <script type=\"application/json\" id=\"imports\">{imports}</script>\n"))
}

/// A file of the page, compressed if the browser accepts gzip.
pub(crate) async fn file(
    uri: Uri,
    headers: HeaderMap,
    Path((version, path)): Path<(String, String)>,
) -> Result<Response> {
    let file = BY_PATH.get(path.as_str()).filter(|_| version == *VERSION && !path.ends_with(".html"));
    let file = file.ok_or_else(|| missing(&uri))?;
    let takes_gzip = middleware::takes_gzip(&headers);
    let form = if takes_gzip { "gzip" } else { "plain" };
    let caching = [
        (header::CONTENT_TYPE, HeaderValue::from_static(content_type(&path))),
        (header::CACHE_CONTROL, HeaderValue::from_static("public, max-age=31536000, immutable")),
        (header::VARY, HeaderValue::from_static("accept-encoding")),
        (header::ETAG, tag(&format!("{path} {form}"))?),
    ];
    if takes_gzip {
        return Ok((caching, usual(), [(header::CONTENT_ENCODING, "gzip")], file.compressed).into_response());
    }
    let plain = file.plain().map_err(|error| Error::internal(&error))?;
    Ok((caching, usual(), plain).into_response())
}

impl File {
    fn plain(&self) -> io::Result<Bytes> {
        if let Some(plain) = self.plain.get() {
            return Ok(plain.clone());
        }
        let mut plain = Vec::new();
        GzDecoder::new(self.compressed).read_to_end(&mut plain)?;
        Ok(self.plain.get_or_init(|| plain.into()).clone())
    }
}

fn missing(uri: &Uri) -> Error {
    Error::new(ProblemKind::NoSuchRoute, format!("there is no page {}", uri.path()))
}

fn tag(path: &str) -> Result<HeaderValue> {
    let tag = blake3::hash(format!("{} {path}", *VERSION).as_bytes()).to_hex();
    HeaderValue::try_from(format!("\"{}\"", &tag[..16])).map_err(|error| Error::internal(&error))
}

fn usual() -> [(header::HeaderName, HeaderValue); 4] {
    [
        (header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY)),
        (header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY")),
        (header::REFERRER_POLICY, HeaderValue::from_static("no-referrer")),
        (
            header::HeaderName::from_static("cross-origin-opener-policy"),
            HeaderValue::from_static("same-origin"),
        ),
    ]
}

fn content_type(path: &str) -> &'static str {
    match path.rsplit('.').next() {
        Some("css") => "text/css; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "application/octet-stream",
    }
}
