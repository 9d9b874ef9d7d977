//! Cache of pictures: twenty viewers of a sweep cost one drawing.

use axum::body::Body;
use axum::response::Response;
use bytes::Bytes;
use quick_cache::Weighter;
use quick_cache::sync::Cache;

use crate::answer::error::Result;
use crate::answer::format::{Answer, Head};

/// Memory of all pictures that are kept \[bytes\].
const MEMORY: u64 = 16 << 20;

/// A picture of usual size \[bytes\].
const USUAL: u64 = 64 << 10;

/// Pictures by the tag of their contents and their file name.
pub(crate) struct Pictures(Cache<String, (Head, Bytes), Size>);

#[derive(Clone)]
struct Size;

impl Weighter<String, (Head, Bytes)> for Size {
    fn weight(&self, key: &String, (_, bytes): &(Head, Bytes)) -> u64 {
        (key.len() + bytes.len()) as u64 + 200
    }
}

impl Pictures {
    pub(crate) fn new() -> Self {
        Self(Cache::with_weighter((MEMORY / USUAL) as usize, MEMORY, Size))
    }

    /// The picture of a key, drawn if it is not kept; while one request draws it, others wait for it.
    ///
    /// # Errors
    /// Errors of drawing; the next request draws again.
    pub(crate) async fn get_or_draw(
        &self,
        key: &str,
        draw: impl Future<Output = Result<Answer>>,
    ) -> Result<Response> {
        let (head, bytes) = match self.0.get_value_or_guard_async(key).await {
            Ok(kept) => kept,
            Err(guard) => {
                let drawn = draw.await?.into_picture()?;
                // Another picture may have been kept in its place meanwhile.
                let _ = guard.insert(drawn.clone());
                drawn
            }
        };
        Ok(head.response(Body::from(bytes)))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use http_body_util::BodyExt as _;

    use super::*;
    use crate::answer::error::Error;

    #[tokio::test]
    async fn viewers_of_one_picture_share_a_drawing_and_a_failed_one_is_retried() {
        let pictures = Arc::new(Pictures::new());
        let drawn = Arc::new(AtomicUsize::new(0));
        let view = |key: &'static str, fails: bool| {
            let (pictures, drawn) = (pictures.clone(), drawn.clone());
            tokio::spawn(async move {
                let draw = async {
                    tokio::task::yield_now().await;
                    drawn.fetch_add(1, Ordering::Relaxed);
                    if fails { Err(Error::internal("it fails")) } else { Ok(Answer::of_bytes(key)) }
                };
                let answer = pictures.get_or_draw(key, draw).await.map_err(Error::into_problem)?;
                let body = answer.into_body().collect().await.expect("a body").to_bytes();
                Ok::<_, drillsweep_api::ProblemDetails>(body)
            })
        };
        assert!(view("a", true).await.expect("it ends").is_err());
        let viewers: Vec<_> = (0..20).map(|_| view("a", false)).collect();
        for viewer in viewers {
            assert_eq!(viewer.await.expect("it ends").expect("a picture"), "a");
        }
        assert_eq!(drawn.load(Ordering::Relaxed), 2);
        assert_eq!(view("b", false).await.expect("it ends").expect("a picture"), "b");
    }
}
