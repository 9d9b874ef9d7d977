//! JSON answers.

use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;

use crate::answer::error::Error;

/// A JSON answer. Not axum's, which writes into a buffer of its own kind: each type of an answer would be compiled for that buffer, for
/// that of event streams, and for the plain bytes that tags are made of.
pub(crate) struct Json<T>(pub(crate) T);

impl<T: Serialize> IntoResponse for Json<T> {
    fn into_response(self) -> Response {
        match serde_json::to_vec(&self.0) {
            Ok(body) => {
                ([(header::CONTENT_TYPE, HeaderValue::from_static("application/json"))], body).into_response()
            }
            Err(error) => Error::internal(&error).into_response(),
        }
    }
}
