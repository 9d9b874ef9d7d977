//! Requests to an object store whose certificate is not accepted: they are reported at once instead of being sent again.

use async_trait::async_trait;
use object_store::ClientOptions;
use object_store::client::{
    HttpClient, HttpConnector, HttpError, HttpErrorKind, HttpRequest, HttpResponse, HttpService,
    ReqwestConnector,
};

use crate::error::untrusted_certificate;

/// Connects as the default of `object_store`, which retries all failures to connect; here a refused certificate is a separate error, which
/// a retry cannot resolve.
#[derive(Debug)]
pub(super) struct Connector;

impl HttpConnector for Connector {
    fn connect(&self, options: &ClientOptions) -> object_store::Result<HttpClient> {
        Ok(HttpClient::new(Service(ReqwestConnector::default().connect(options)?)))
    }
}

#[derive(Debug)]
struct Service(HttpClient);

#[async_trait]
impl HttpService for Service {
    async fn call(&self, request: HttpRequest) -> Result<HttpResponse, HttpError> {
        self.0.execute(request).await.map_err(|error| match untrusted_certificate(&error) {
            Some(_) => HttpError::new(HttpErrorKind::Unknown, error),
            None => error,
        })
    }
}
