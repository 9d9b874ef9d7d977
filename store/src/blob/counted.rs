//! Counting requests to an object store.

use std::fmt;
use std::ops::Range;
use std::time::Instant;

use async_trait::async_trait;
use bytes::Bytes;
use futures::stream::BoxStream;
use futures::{FutureExt as _, StreamExt as _};
use object_store::path::Path;
use object_store::{
    CopyOptions, GetOptions, GetResult, ListResult, MultipartUpload, ObjectMeta, ObjectStore,
    PutMultipartOptions, PutOptions, PutPayload, PutResult, Result, UploadPart,
};

use crate::blob::metrics::ObjectMetrics;

/// An object store whose requests are counted.
#[derive(Debug)]
pub(super) struct Counted<T> {
    inner: T,
    metrics: ObjectMetrics,
}

impl<T> Counted<T> {
    pub(super) fn new(inner: T, metrics: ObjectMetrics) -> Self {
        Self { inner, metrics }
    }
}

impl<T: fmt::Display> fmt::Display for Counted<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.inner.fmt(formatter)
    }
}

#[async_trait]
impl<T: ObjectStore> ObjectStore for Counted<T> {
    async fn put_opts(&self, location: &Path, payload: PutPayload, options: PutOptions) -> Result<PutResult> {
        let (begun, bytes) = (Instant::now(), payload.content_length());
        let answer = self.inner.put_opts(location, payload, options).await;
        self.metrics.request("put", begun, &answer);
        if answer.is_ok() {
            self.metrics.transfer("put", bytes as u64);
        }
        answer
    }

    async fn put_multipart_opts(
        &self,
        location: &Path,
        options: PutMultipartOptions,
    ) -> Result<Box<dyn MultipartUpload>> {
        let begun = Instant::now();
        let answer = self.inner.put_multipart_opts(location, options).await;
        self.metrics.request("begin", begun, &answer);
        Ok(Box::new(CountedUpload { inner: answer?, metrics: self.metrics.clone() }))
    }

    async fn get_opts(&self, location: &Path, options: GetOptions) -> Result<GetResult> {
        let (begun, operation) = (Instant::now(), if options.head { "head" } else { "get" });
        let answer = self.inner.get_opts(location, options).await;
        self.metrics.request(operation, begun, &answer);
        if let Ok(result) = &answer
            && operation == "get"
        {
            self.metrics.transfer("get", result.range.end - result.range.start);
        }
        answer
    }

    async fn get_ranges(&self, location: &Path, ranges: &[Range<u64>]) -> Result<Vec<Bytes>> {
        let begun = Instant::now();
        let answer = self.inner.get_ranges(location, ranges).await;
        self.metrics.request("get", begun, &answer);
        if let Ok(parts) = &answer {
            self.metrics.transfer("get", parts.iter().map(|part| part.len() as u64).sum());
        }
        answer
    }

    fn delete_stream(&self, locations: BoxStream<'static, Result<Path>>) -> BoxStream<'static, Result<Path>> {
        let (begun, metrics) = (Instant::now(), self.metrics.clone());
        let deleted = self.inner.delete_stream(locations);
        deleted.inspect(move |answer| metrics.request("delete", begun, answer)).boxed()
    }

    fn list(&self, prefix: Option<&Path>) -> BoxStream<'static, Result<ObjectMeta>> {
        self.inner.list(prefix)
    }

    fn list_with_offset(
        &self,
        prefix: Option<&Path>,
        offset: &Path,
    ) -> BoxStream<'static, Result<ObjectMeta>> {
        self.inner.list_with_offset(prefix, offset)
    }

    async fn list_with_delimiter(&self, prefix: Option<&Path>) -> Result<ListResult> {
        self.inner.list_with_delimiter(prefix).await
    }

    async fn copy_opts(&self, from: &Path, to: &Path, options: CopyOptions) -> Result<()> {
        self.inner.copy_opts(from, to, options).await
    }
}

#[derive(Debug)]
struct CountedUpload {
    inner: Box<dyn MultipartUpload>,
    metrics: ObjectMetrics,
}

#[async_trait]
impl MultipartUpload for CountedUpload {
    fn put_part(&mut self, data: PutPayload) -> UploadPart {
        let (begun, bytes) = (Instant::now(), data.content_length());
        let (part, metrics) = (self.inner.put_part(data), self.metrics.clone());
        async move {
            let answer = part.await;
            metrics.request("part", begun, &answer);
            if answer.is_ok() {
                metrics.transfer("put", bytes as u64);
            }
            answer
        }
        .boxed()
    }

    async fn complete(&mut self) -> Result<PutResult> {
        let begun = Instant::now();
        let answer = self.inner.complete().await;
        self.metrics.request("complete", begun, &answer);
        answer
    }

    async fn abort(&mut self) -> Result<()> {
        self.inner.abort().await
    }
}
