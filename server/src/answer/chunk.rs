//! Parts of bodies that are made while they are sent, as the client takes them.

use std::io;
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes};
use futures::StreamExt;
use tokio::sync::mpsc;
use tokio::time::timeout;

use crate::answer::error::{Error, Result};
use crate::answer::eviction::Eviction;

/// How long a client may take to make room for a chunk: whoever takes less does not read, but hold what others wait for.
const PATIENCE: Duration = Duration::from_secs(60);

/// How often an answer that waits for its client looks whether it is to be evicted.
const LOOK: Duration = Duration::from_millis(250);

/// A part of a body.
pub(crate) enum Chunk {
    One(Bytes),
    Last(Bytes),
}

/// A body of chunks: `first`, and those that come. One that ends without its last breaks off.
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
    // Compression polls a stream beyond its end.
    Body::from_stream(chunks.fuse())
}

/// Error that breaks off a body.
fn broken_off(error: Error) -> io::Error {
    let detail = error.into_problem().detail;
    tracing::error!(detail, "an answer was broken off");
    io::Error::other(detail)
}

/// Room for a chunk, as soon as the client makes some; none if it has gone away, takes nothing, or is so slow that the answer is evicted for others.
pub(crate) async fn room<'s, T>(
    sender: &'s mpsc::Sender<T>,
    eviction: &mut Eviction,
) -> Option<mpsc::Permit<'s, T>> {
    let began = Instant::now();
    loop {
        match timeout(LOOK, sender.reserve()).await {
            Ok(room) => {
                eviction.note(began.elapsed());
                return room.ok();
            }
            Err(_) if began.elapsed() >= PATIENCE || eviction.is_due(began.elapsed()) => return None,
            Err(_) => {}
        }
    }
}
