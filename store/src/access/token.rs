//! Tokens: access to the service, with scopes.

use crate::engine::query::{Row, query};
use crate::engine::sql;
use crate::error::{Result, StoreError};
use crate::store::Store;

/// Largest delay of `last_used` \[ms\]: it is for people, and not worth a write a request.
const LAST_USED_STEP_MS: i64 = 3_600_000;

/// Characters of a token's text.
const SECRET_LENGTH: std::ops::RangeInclusive<usize> = 32..=200;

/// Permissions of a token; each scope includes those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TokenScope {
    /// Reading everything.
    Read,
    /// Submitting sweeps, and changing one's own.
    Submit,
    /// Changing sweeps of any owner, and submitting for any owner.
    Admin,
}

/// The text of a token. It is shown once, when it is made; the store keeps its hash. `Debug` does not print it.
#[derive(Clone)]
pub struct TokenSecret(String);

/// A token to store.
#[derive(Debug)]
pub struct NewToken<'a> {
    /// Its text.
    pub secret: &'a TokenSecret,
    /// Owner of the sweeps that are submitted with it.
    pub owner: &'a str,
    /// A name for people, such as the machine that it is for.
    pub name: Option<&'a str>,
    /// Permissions.
    pub scope: TokenScope,
    /// Validity \[ms\]; `None` means without end.
    pub lifetime_ms: Option<i64>,
}

/// A stored token.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TokenRecord {
    /// Identifier; not secret.
    pub id: String,
    /// Owner of the sweeps that are submitted with it.
    pub owner: String,
    /// A name for people.
    pub name: Option<String>,
    /// Permissions.
    pub scope: TokenScope,
    /// Time of its creation \[ms since the epoch\].
    pub created: i64,
    /// End of its validity \[ms since the epoch\].
    pub expires: Option<i64>,
    /// Time of its revocation \[ms since the epoch\].
    pub revoked: Option<i64>,
    /// Time of its last use, to within an hour \[ms since the epoch\].
    pub last_used: Option<i64>,
}

/// Presence of tokens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TokensPresent {
    /// There has never been one.
    None,
    /// There are some, but all have expired or were revoked.
    OnlyVoid,
    /// At least one is valid.
    Valid,
}

impl TokenScope {
    /// The name in the database and on the command line.
    pub fn as_str(self) -> &'static str {
        match self {
            TokenScope::Read => "read",
            TokenScope::Submit => "submit",
            TokenScope::Admin => "admin",
        }
    }

    fn parse(text: &str) -> Result<Self> {
        Ok(match text {
            "read" => TokenScope::Read,
            "submit" => TokenScope::Submit,
            "admin" => TokenScope::Admin,
            other => return Err(StoreError::Corrupt(format!("token scope {other:?}"))),
        })
    }
}

impl TokenSecret {
    /// A new one of 256 random bits: `dsw_` and 64 hexadecimal digits, so that scanners for leaked secrets know it.
    ///
    /// # Errors
    /// The system has no random numbers.
    pub fn generate() -> Result<Self> {
        let mut bytes = [0; 32];
        getrandom::fill(&mut bytes).map_err(|error| StoreError::Random(error.to_string()))?;
        let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(TokenSecret(format!("dsw_{digits}")))
    }

    /// One that was made elsewhere: 32 to 200 visible ASCII characters. None for any other text.
    pub fn parse(text: &str) -> Option<Self> {
        let is_valid =
            SECRET_LENGTH.contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_graphic());
        is_valid.then(|| TokenSecret(text.to_owned()))
    }

    /// The text itself.
    pub fn expose(&self) -> &str {
        &self.0
    }

    /// The identifier under which the store knows it.
    pub fn id(&self) -> String {
        self.hash().to_hex()[..12].to_owned()
    }

    pub(crate) fn hash(&self) -> blake3::Hash {
        blake3::hash(self.0.as_bytes())
    }
}

impl std::fmt::Debug for TokenSecret {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("TokenSecret(...)")
    }
}

impl Store {
    /// Stores a token. One whose text is stored already stays as it is.
    ///
    /// # Errors
    /// The database fails.
    pub async fn create_token(&self, token: &NewToken<'_>) -> Result<()> {
        query(sql::token::CREATE)
            .bind(token.secret.id())
            .bind(token.secret.hash().as_bytes().as_slice())
            .bind(token.owner)
            .bind(token.name)
            .bind(token.scope.as_str())
            .bind(token.lifetime_ms)
            .execute(&self.database)
            .await?;
        Ok(())
    }

    /// All tokens, oldest first, those that are not valid any more too.
    ///
    /// # Errors
    /// The database fails.
    pub async fn tokens(&self) -> Result<Vec<TokenRecord>> {
        query(sql::token::LIST).records(&self.database, TokenRecord::read).await
    }

    /// Makes a token void, at once and for good. False if there is no such token.
    ///
    /// # Errors
    /// The database fails.
    pub async fn revoke_token(&self, id: &str) -> Result<bool> {
        let changed = query(sql::token::REVOKE).bind(id).execute(&self.database).await?;
        Ok(changed == 1)
    }

    /// The token of a text, if it is valid now. The time of looking a hash up reveals nothing about the text.
    ///
    /// # Errors
    /// The database fails.
    pub async fn valid_token(&self, secret: &TokenSecret) -> Result<Option<TokenRecord>> {
        query(sql::token::VALID)
            .bind(secret.hash().as_bytes().as_slice())
            .first_record(&self.database, TokenRecord::read)
            .await
    }

    /// Notes that a token was used, unless that was noted within the hour.
    ///
    /// # Errors
    /// The database fails.
    pub async fn touch_token(&self, token: &TokenRecord) -> Result<()> {
        let now = self.now_ms().await?;
        if token.last_used.is_some_and(|last| now - last < LAST_USED_STEP_MS) {
            return Ok(());
        }
        query(sql::token::TOUCH).bind(&token.id).bind(now).execute(&self.database).await?;
        Ok(())
    }

    /// Presence of tokens, and of valid ones among them.
    ///
    /// # Errors
    /// The database fails.
    pub async fn tokens_present(&self) -> Result<TokensPresent> {
        let (number, valid): (i64, i64) = query(sql::token::PRESENT).one(&self.database).await?;
        Ok(match (number, valid) {
            (0, _) => TokensPresent::None,
            (_, 0) => TokensPresent::OnlyVoid,
            _ => TokensPresent::Valid,
        })
    }
}

impl TokenRecord {
    pub(crate) fn read(row: &Row) -> Result<Self> {
        Ok(Self {
            id: row.get("id")?,
            owner: row.get("owner")?,
            name: row.get("name")?,
            scope: TokenScope::parse(&row.get::<String>("scope")?)?,
            created: row.get("created")?,
            expires: row.get("expires")?,
            revoked: row.get("revoked")?,
            last_used: row.get("last_used")?,
        })
    }
}
