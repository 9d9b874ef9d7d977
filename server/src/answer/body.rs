//! Bodies that are written while they are sent, by a thread that waits for the client, so that only chunks are in memory.

use std::io::{self, Write};
use std::sync::Arc;

use axum::body::Body;
use axum::response::Response;
use tokio::runtime::Handle;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc, oneshot};

use crate::answer::blocking::beside;
use crate::answer::chunk::{self, Allowance, Chunk};
use crate::answer::error::{Error, Result};
use crate::answer::format::Answer;

/// Size of a chunk \[bytes\].
const CHUNK: usize = 64 << 10;

/// Chunks that may wait for the client before the writer waits.
pub(crate) const WAITING_CHUNKS: usize = 2;

/// Memory of a body while it is sent \[bytes\].
pub(crate) const MEMORY_OF_BODY: u64 = ((WAITING_CHUNKS + 3) * CHUNK) as u64;

/// Writes an answer on a separate thread, which holds a turn while it computes and `held` until it ends. An error before the first chunk is
/// full becomes a problem, an answer of one chunk has a length, and a later error breaks off the body.
pub(crate) async fn send(
    turns: Arc<Semaphore>,
    allowance: Allowance,
    held: impl Send + 'static,
    prepare: impl FnOnce() -> Result<Answer> + Send + 'static,
) -> Result<Response> {
    let (sender, mut receiver) = mpsc::channel(WAITING_CHUNKS);
    let (head, heading) = oneshot::channel();
    let (span, handle) = (tracing::Span::current(), Handle::current());
    beside(move || {
        let _entered = span.enter();
        let _held = held;
        let mut sink = Sink::new(sender, handle, Some(turns), allowance);
        let answer = match prepare() {
            Ok(answer) => answer,
            Err(error) => return sink.fail(error),
        };
        // An error means that the request has ended.
        let _ = head.send(answer.head());
        let written = answer.write(&mut sink);
        match written {
            Ok(()) => sink.finish(),
            Err(_) if sink.is_abandoned() => {}
            Err(error) => sink.fail(answer.problem(error)),
        }
    })?;
    let ended = || Error::internal("the thread that writes an answer has ended");
    let first = receiver.recv().await.ok_or_else(ended)??;
    let head = heading.await.map_err(|_| ended())?;
    Ok(head.response(match first {
        Chunk::Last(bytes) => Body::from(bytes),
        first @ Chunk::One(_) => chunk::body(Some(first), receiver),
    }))
}

/// Chunks on their way to the client.
pub(crate) struct Sink {
    sender: mpsc::Sender<Result<Chunk>>,
    buffer: Vec<u8>,
    handle: Handle,
    /// Source of turns to compute, and the turn that is held.
    turns: Option<Arc<Semaphore>>,
    turn: Option<OwnedSemaphorePermit>,
    allowance: Allowance,
    is_abandoned: bool,
}

impl Sink {
    /// A sink for a thread that computes in turns, or at any time without `turns`.
    pub(crate) fn new(
        sender: mpsc::Sender<Result<Chunk>>,
        handle: Handle,
        turns: Option<Arc<Semaphore>>,
        allowance: Allowance,
    ) -> Self {
        let mut sink =
            Sink { sender, buffer: Vec::new(), handle, turns, turn: None, allowance, is_abandoned: false };
        sink.take_turn();
        sink
    }

    fn take_turn(&mut self) {
        if let Some(turns) = &self.turns {
            // The semaphore is never closed.
            self.turn = self.handle.block_on(turns.clone().acquire_owned()).ok();
        }
    }

    /// Sends the rest of the buffer as the end of the body.
    pub(crate) fn finish(mut self) {
        let bytes = std::mem::take(&mut self.buffer);
        let _ = self.send(Ok(Chunk::Last(bytes.into())));
    }

    /// Breaks the body off.
    pub(crate) fn fail(mut self, error: Error) {
        let _ = self.send(Err(error));
    }

    /// True if the client has gone away or is too slow.
    pub(crate) fn is_abandoned(&self) -> bool {
        self.is_abandoned
    }

    /// Sends a chunk; the turn is free while this thread waits for its client.
    fn send(&mut self, chunk: Result<Chunk>) -> io::Result<()> {
        self.turn = None;
        let bytes = match &chunk {
            Ok(Chunk::One(bytes) | Chunk::Last(bytes)) => bytes.len(),
            Err(_) => 0,
        };
        let Some(room) = self.handle.block_on(self.allowance.room(&self.sender, bytes)) else {
            self.is_abandoned = true;
            return Err(io::ErrorKind::BrokenPipe.into());
        };
        room.send(chunk);
        Ok(())
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.is_abandoned {
            // The writer got an error before; a dropped archive still writes its directory, which is discarded.
            return Ok(bytes.len());
        }
        // Reserved in full: a growing buffer fragments the heap.
        self.buffer.reserve_exact(CHUNK - self.buffer.len());
        let count = bytes.len().min(CHUNK - self.buffer.len());
        self.buffer.extend_from_slice(&bytes[..count]);
        if self.buffer.len() == CHUNK {
            let chunk = std::mem::take(&mut self.buffer);
            self.send(Ok(Chunk::One(chunk.into())))?;
            self.take_turn();
        }
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
