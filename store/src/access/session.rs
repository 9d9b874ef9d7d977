//! Sessions: browsers that have logged in by a token. A browser keeps the session's secret, not the token; its permissions end with either.

use crate::access::token::{TokenRecord, TokenSecret};
use crate::engine::query::query;
use crate::engine::sql;
use crate::error::Result;
use crate::store::Store;

/// Validity of a session \[ms\]: 30 days, and no longer than its token.
const SESSION_MS: i64 = 30 * 24 * 3_600_000;

/// A session that is valid now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SessionRecord {
    /// The token that it was opened by.
    pub token: TokenRecord,
    /// End of its validity \[ms since the epoch\].
    pub expires: i64,
}

impl Store {
    /// Opens a session by a token. Gives the text that the browser is to keep; the store keeps its hash.
    ///
    /// # Errors
    /// The database fails, or the system has no random numbers.
    pub async fn open_session(&self, token: &TokenRecord) -> Result<TokenSecret> {
        let secret = TokenSecret::generate()?;
        query(sql::session::OPEN)
            .bind(secret.hash().as_bytes().as_slice())
            .bind(&token.id)
            .bind(SESSION_MS)
            .execute(&self.database)
            .await?;
        Ok(secret)
    }

    /// The session of a text; none if it or its token is not valid.
    ///
    /// # Errors
    /// The database fails.
    pub async fn session(&self, secret: &TokenSecret) -> Result<Option<SessionRecord>> {
        query(sql::session::TOKEN)
            .bind(secret.hash().as_bytes().as_slice())
            .first_record(&self.database, |row| {
                Ok(SessionRecord { token: TokenRecord::read(row)?, expires: row.get("session_expires")? })
            })
            .await
    }

    /// Closes a session, if there is one of this text.
    ///
    /// # Errors
    /// The database fails.
    pub async fn close_session(&self, secret: &TokenSecret) -> Result<()> {
        query(sql::session::CLOSE).bind(secret.hash().as_bytes().as_slice()).execute(&self.database).await?;
        Ok(())
    }
}
