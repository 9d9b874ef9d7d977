//! The API's document as pages for people, by Swagger UI. The pages come with the program, so that they need no other network.

use std::io::{Cursor, Read as _};
use std::sync::LazyLock;

use axum::http::{Uri, header};
use axum::response::{IntoResponse, Redirect, Response};
use drillsweep_api::ProblemKind;
use utoipa_swagger_ui_vendored::SWAGGER_UI_VENDORED;
use zip::ZipArchive;
use zip::result::ZipResult;

use crate::answer::error::{Error, Result};
use crate::answer::extract::Path;

/// A release of Swagger UI: all in one folder, the pages in its folder `dist`.
static RELEASE: LazyLock<ZipArchive<Cursor<&[u8]>>> = LazyLock::new(|| {
    ZipArchive::new(Cursor::new(SWAGGER_UI_VENDORED)).expect("the built-in archive is well-formed")
});

/// The file that says what the pages show, and its text in place of the release's, which shows an example.
const INITIALIZER: (&str, &str) = ("swagger-initializer.js", include_str!("swagger-initializer.js"));

/// What the pages may load: files of this service alone, and no page may hold them in a frame. Swagger UI sets styles of its elements,
/// and has icons in its own text.
const POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; frame-ancestors 'none'; \
    base-uri 'none'; form-action 'self'";

/// To the first page, whose other files are beside it.
pub(crate) async fn start() -> Redirect {
    Redirect::permanent("/docs/index.html")
}

/// One file of the pages.
pub(crate) async fn file(uri: Uri, Path(name): Path<String>) -> Result<Response> {
    let bytes = if name == INITIALIZER.0 {
        Some(INITIALIZER.1.into())
    } else {
        page(&name).map_err(|error| Error::internal(&error))?
    };
    let missing = || Error::new(ProblemKind::NoSuchRoute, format!("there is nothing at {}", uri.path()));
    let usual = [
        (header::CONTENT_TYPE, content_type(&name)),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    Ok((usual, bytes.ok_or_else(missing)?).into_response())
}

/// A file of the release's pages; none if there is no such file.
fn page(name: &str) -> ZipResult<Option<Vec<u8>>> {
    let end = format!("/dist/{name}");
    let is_page =
        |path: &[u8]| path.strip_suffix(end.as_bytes()).is_some_and(|release| !release.contains(&b'/'));
    let Some(index) = RELEASE.file_names_raw().position(is_page) else { return Ok(None) };
    let mut bytes = Vec::new();
    RELEASE.clone().by_index(index)?.read_to_end(&mut bytes)?;
    Ok(Some(bytes))
}

fn content_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html",
        Some("css") => "text/css",
        Some("js") => "text/javascript",
        Some("png") => "image/png",
        _ => "application/octet-stream",
    }
}
