//! The caller of a request.

use drillsweep_api::ProblemKind;
use drillsweep_store::{TokenRecord, TokenScope};

use crate::answer::error::{Error, Result};

/// Caller of a request.
#[derive(Debug, Clone)]
pub(crate) enum Caller {
    /// A local caller, while there are no tokens.
    Local,
    /// The owner of a token.
    Bearer(TokenRecord),
}

impl Caller {
    /// Owner of a submitted sweep: that of the token, or with scope admin the named one. `None` if the request names no owner.
    pub(crate) fn submits_as(&self, asked: Option<String>) -> Result<Option<String>> {
        match (self, asked) {
            (Caller::Local, asked) => Ok(asked),
            (Caller::Bearer(token), None) => Ok(Some(token.owner.clone())),
            (Caller::Bearer(token), Some(asked))
                if token.scope == TokenScope::Admin || token.owner == asked =>
            {
                Ok(Some(asked))
            }
            (Caller::Bearer(token), Some(asked)) => {
                let detail = format!(
                    "owner: this token submits for {}, not for {asked}; omit the owner, or use an admin token",
                    token.owner
                );
                Err(Error::new(ProblemKind::Forbidden, detail))
            }
        }
    }

    /// Token of the request.
    pub(crate) fn token(&self) -> Option<&TokenRecord> {
        match self {
            Caller::Local => None,
            Caller::Bearer(token) => Some(token),
        }
    }

    /// Owner whose rate limit a request counts against.
    pub(crate) fn budget(&self) -> &str {
        match self {
            Caller::Local => "",
            Caller::Bearer(token) => &token.owner,
        }
    }
}
