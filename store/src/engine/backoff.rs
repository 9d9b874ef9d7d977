//! Retry with backoff of a process that is started while its database is not there yet, or not any more.

use std::time::{Duration, Instant};

use crate::error::Result;

/// Time for which a process waits for its database: as long as for its object store.
const RETRY_FOR: Duration = Duration::from_secs(60);

/// Retries with backoff for a minute, as long as the database is busy or does not answer. It serves the opening of a store; later, servers
/// report such an error to their clients, and workers retry by themselves.
///
/// # Errors
/// The error of the last attempt.
pub async fn with_backoff<T, F: Future<Output = Result<T>>>(mut attempt: impl FnMut() -> F) -> Result<T> {
    /// The longest wait between two attempts.
    const LONGEST: Duration = Duration::from_secs(4);
    let deadline = Instant::now() + RETRY_FOR;
    let mut pause = Duration::from_millis(250);
    loop {
        match attempt().await {
            Err(error) if error.is_busy() && Instant::now() + pause < deadline => {
                tracing::warn!(%error, "the database does not answer; retrying");
            }
            ended => return ended,
        }
        tokio::time::sleep(pause).await;
        pause = LONGEST.min(2 * pause);
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::io::{Error, ErrorKind};

    use super::*;
    use crate::error::StoreError;

    #[tokio::test]
    async fn transient_failures_are_retried_and_permanent_ones_returned_at_once() {
        let broken_off = || StoreError::Database(sqlx::Error::Io(Error::from(ErrorKind::ConnectionReset)));
        let attempts = Cell::new(0);
        let attempt = |until: i32, lasting: fn() -> StoreError| {
            attempts.set(attempts.get() + 1);
            let ended = match attempts.get() {
                number if number < until => Err(broken_off()),
                _ => Err(lasting()),
            };
            async move { ended }
        };
        let wrong = || StoreError::Corrupt("a wrong password".to_owned());
        let ended: Result<()> = with_backoff(|| attempt(2, wrong)).await;
        assert!(matches!(ended, Err(StoreError::Corrupt(_))));
        assert_eq!(attempts.get(), 2, "one more after the connection broke off, none after what stays");
    }
}
