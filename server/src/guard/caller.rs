//! The caller of a request.

use drillsweep_api::ProblemKind;
use drillsweep_store::{TokenRecord, TokenScope};

use crate::answer::error::{Error, Result};

/// Caller of a request.
#[derive(Debug, Clone)]
pub(crate) enum Caller {
    /// Somebody on this machine, while there are no tokens.
    Local,
    /// The bearer of a token.
    Bearer(TokenRecord),
}

impl Caller {
    /// In whose name a sweep is submitted: the token's owner, or for those who may choose, the one they name. None
    /// means that the request does not say.
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
                    "owner: this token submits for {}, not for {asked}; leave the owner out, or use an admin token",
                    token.owner
                );
                Err(Error::new(ProblemKind::Forbidden, detail))
            }
        }
    }

    /// The token that the request came with.
    pub(crate) fn token(&self) -> Option<&TokenRecord> {
        match self {
            Caller::Local => None,
            Caller::Bearer(token) => Some(token),
        }
    }

    /// Owner whose budget of requests a request is taken from.
    pub(crate) fn budget(&self) -> &str {
        match self {
            Caller::Local => "",
            Caller::Bearer(token) => &token.owner,
        }
    }
}
