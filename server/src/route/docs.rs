//! The API's document as pages for people, by Swagger UI. The pages come with the program, so that they need no other network.

use std::sync::{Arc, LazyLock};

use axum::http::{Uri, header};
use axum::response::{IntoResponse, Redirect, Response};
use drillsweep_api::ProblemKind;
use utoipa_swagger_ui::Config;

use crate::answer::error::{Error, Result};
use crate::answer::extract::Path;

/// What the pages show.
static CONFIG: LazyLock<Arc<Config<'static>>> = LazyLock::new(|| Arc::new(Config::from("/openapi.json")));

/// To the first page, whose other files are beside it.
pub(crate) async fn start() -> Redirect {
    Redirect::permanent("/docs/index.html")
}

/// One file of the pages.
pub(crate) async fn file(uri: Uri, Path(name): Path<String>) -> Result<Response> {
    match utoipa_swagger_ui::serve(&name, CONFIG.clone()) {
        Ok(Some(file)) => {
            Ok(([(header::CONTENT_TYPE, file.content_type)], file.bytes.into_owned()).into_response())
        }
        Ok(None) => Err(Error::new(ProblemKind::NoSuchRoute, format!("there is nothing at {}", uri.path()))),
        Err(error) => Err(Error::internal(&error)),
    }
}
