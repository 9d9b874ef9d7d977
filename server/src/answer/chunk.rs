//! Chunks of bodies that are made while they are sent, at the pace of the client.

use std::io;
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes};
use futures::StreamExt;
use tokio::sync::mpsc;
use tokio::time::timeout;

use crate::answer::error::{Error, Result};

/// Least mean rate at which clients have to take answers that hold memory \[bytes/s\].
const LEAST_RATE: f64 = 32e3;

/// A chunk of a body.
pub(crate) enum Chunk {
    One(Bytes),
    Last(Bytes),
}

/// A body of `first` and the chunks received after it. It breaks off if they end without a last one.
pub(crate) fn body(first: Option<Chunk>, receiver: mpsc::Receiver<Result<Chunk>>) -> Body {
    let chunks = futures::stream::unfold(Some((first, receiver)), async |state| {
        let (first, mut receiver) = state?;
        let chunk = match first {
            Some(first) => Some(Ok(first)),
            None => receiver.recv().await,
        };
        Some(match chunk {
            Some(Ok(Chunk::One(bytes))) => (Ok(bytes), Some((None, receiver))),
            Some(Ok(Chunk::Last(bytes))) => (Ok(bytes), None),
            Some(Err(error)) => (Err(broken_off(error)), None),
            None => (Err(io::ErrorKind::UnexpectedEof.into()), None),
        })
    });
    // Compression polls a stream after its end.
    Body::from_stream(chunks.fuse())
}

/// Error that breaks off a body.
fn broken_off(error: Error) -> io::Error {
    let detail = error.into_problem().detail;
    tracing::error!(detail, "a response was aborted");
    io::Error::other(detail)
}

/// Time that a client may still keep an answer waiting. A few slow clients would otherwise hold the memory of all answers for hours.
pub(crate) struct Allowance {
    left: Duration,
    longest: Duration,
}

impl Allowance {
    pub(crate) fn new(longest: Duration) -> Self {
        Self { left: longest, longest }
    }

    /// Room for a chunk of `bytes` as soon as the client makes some, which renews the allowance by the time that the chunk takes at
    /// [`LEAST_RATE`]; `None` if the client has gone away, or has used the allowance up.
    pub(crate) async fn room<'s, T>(
        &mut self,
        sender: &'s mpsc::Sender<T>,
        bytes: usize,
    ) -> Option<mpsc::Permit<'s, T>> {
        let began = Instant::now();
        let Ok(room) = timeout(self.left, sender.reserve()).await else {
            tracing::warn!("a response is aborted: its client reads less than {LEAST_RATE} bytes/s");
            return None;
        };
        self.note(began.elapsed(), bytes);
        room.ok()
    }

    fn note(&mut self, waited: Duration, bytes: usize) {
        let renewed = Duration::from_secs_f64(bytes as f64 / LEAST_RATE);
        self.left = self.left.saturating_sub(waited).saturating_add(renewed).min(self.longest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seconds after which a client is broken off that takes 64 kB every `interval`; `None` if it never is.
    fn broken_off_after(interval: f64) -> Option<f64> {
        let mut allowance = Allowance::new(Duration::from_secs(30));
        for taken in 0..1_000 {
            if allowance.left < Duration::from_secs_f64(interval) {
                return Some(f64::from(taken) * interval + allowance.left.as_secs_f64());
            }
            allowance.note(Duration::from_secs_f64(interval), 64_000);
        }
        None
    }

    #[test]
    fn a_client_has_to_take_32_kb_a_second() {
        assert_eq!(broken_off_after(1.99), None);
        // It loses 1 s with each chunk.
        assert_eq!(broken_off_after(3.0), Some(86.0));
        assert_eq!(broken_off_after(3_600.0), Some(30.0));
    }
}
