//! Tokens: making, listing and revoking them, directly in the database.

use std::path::Path;
use std::str::FromStr;
use std::time::Duration;

use anyhow::Context;
use clap::{Args, Subcommand, ValueEnum};
use drillsweep_api::{LIMITS, time_span};
use drillsweep_store::{NewToken, Role, Store, TokenRecord, TokenScope, TokenSecret};
use serde_json::json;

use crate::data::DataArguments;
use crate::print;

#[derive(Subcommand)]
pub(crate) enum TokenCommand {
    /// Create a token and print it. It is shown only once; the database keeps its hash.
    Create(CreateArguments),
    /// List the tokens, without their texts.
    List {
        #[command(flatten)]
        data: DataArguments,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// Revoke a token, at once and for good.
    Revoke {
        #[command(flatten)]
        data: DataArguments,
        /// Identifier of the token, as `token list` shows it.
        id: String,
    },
}

#[derive(Args)]
pub(crate) struct CreateArguments {
    #[command(flatten)]
    data: DataArguments,
    /// Owner of the sweeps that are submitted with it.
    #[arg(long)]
    owner: String,
    /// Permissions; each scope includes those before it.
    #[arg(long, value_enum, default_value = "submit")]
    scope: Scope,
    /// Name of the token, such as that of the machine that uses it.
    #[arg(long)]
    name: Option<String>,
    /// Validity: a time span such as `90d` or `12h`, or `never` for no end.
    #[arg(long, value_name = "TIME_SPAN", default_value = "365d")]
    expires: Lifetime,
}

#[derive(Clone, Copy, ValueEnum)]
enum Scope {
    /// Reading everything.
    Read,
    /// Submitting sweeps, and changing one's own.
    Submit,
    /// Changing sweeps of any owner, and submitting for any owner.
    Admin,
}

/// The shortest and the longest that something lasts.
const SHORTEST: Duration = Duration::from_secs(1);
const LONGEST: Duration = Duration::from_secs(36_500 * 86_400);

/// Time span \[ms\]; `None` means without end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Lifetime(pub(crate) Option<i64>);

impl FromStr for Lifetime {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "never" {
            return Ok(Lifetime(None));
        }
        // A number alone may be meant as days.
        let has_unit = text.parse::<f64>().is_err();
        let span = time_span::parse(text).ok().filter(|span| has_unit && (SHORTEST..=LONGEST).contains(span));
        let milliseconds = span.and_then(|span| i64::try_from(span.as_millis()).ok());
        let invalid = || "must be a time span such as 90d or 12h, up to a hundred years, or never".to_owned();
        milliseconds.map(|milliseconds| Lifetime(Some(milliseconds))).ok_or_else(invalid)
    }
}

pub(crate) fn token(command: &TokenCommand) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        match command {
            TokenCommand::Create(arguments) => create(arguments).await,
            TokenCommand::List { data, json } => list(data, *json).await,
            TokenCommand::Revoke { data, id } => revoke(data, id).await,
        }
    })
}

async fn create(arguments: &CreateArguments) -> anyhow::Result<()> {
    let CreateArguments { data, owner, scope, name, expires } = arguments;
    let length = owner.chars().count();
    anyhow::ensure!(
        (1..=LIMITS.owner_length).contains(&length) && !owner.chars().any(char::is_control),
        "--owner must have 1 to {} characters",
        LIMITS.owner_length
    );
    let scope = match scope {
        Scope::Read => TokenScope::Read,
        Scope::Submit => TokenScope::Submit,
        Scope::Admin => TokenScope::Admin,
    };
    let store = Store::open(&data.store(Role::Server)?).await?;
    let secret = TokenSecret::generate()?;
    let token = NewToken { secret: &secret, owner, name: name.as_deref(), scope, lifetime_ms: expires.0 };
    store.create_token(&token).await?;
    store.close().await;
    print(secret.expose());
    tracing::info!(id = secret.id(), owner, scope = scope.as_str(), "token created; it is shown only once");
    Ok(())
}

async fn list(data: &DataArguments, json: bool) -> anyhow::Result<()> {
    let store = Store::open_read_only(&data.existing_store(Role::Server)?).await?;
    let (tokens, now) = (store.tokens().await?, store.now_ms().await?);
    store.close().await;
    if json {
        let tokens: Vec<_> = tokens.iter().map(|token| as_json(token, now)).collect();
        print(&serde_json::to_string_pretty(&tokens)?);
        return Ok(());
    }
    print(&format!("{:<12}  {:<7}  {:<8}  {:<20}  {:<20}  name", "id", "scope", "state", "owner", "expires"));
    for token in &tokens {
        let expires = token.expires.map_or_else(|| "never".to_owned(), time);
        let (scope, name) = (token.scope.as_str(), token.name.as_deref().unwrap_or_default());
        let state = state(token, now);
        print(&format!(
            "{:<12}  {scope:<7}  {state:<8}  {:<20}  {expires:<20}  {name}",
            token.id, token.owner
        ));
    }
    Ok(())
}

async fn revoke(data: &DataArguments, id: &str) -> anyhow::Result<()> {
    let store = Store::open(&data.existing_store(Role::Server)?).await?;
    let found = store.revoke_token(id).await?;
    store.close().await;
    anyhow::ensure!(found, "there is no token {id}; `drillsweep token list` shows all tokens");
    tracing::info!(id, "token revoked");
    Ok(())
}

/// Registers the text in a file as an administrator's token, so that a service can start with one that was made
/// elsewhere, such as a container's secret.
pub(crate) async fn register(store: &Store, path: &Path) -> anyhow::Result<()> {
    let text = std::fs::read_to_string(path)
        .with_context(|| format!("the administrator's token cannot be read from {}", path.display()))?;
    let secret = TokenSecret::parse(text.trim_end()).with_context(|| {
        format!("{} must hold one token: 32 to 200 visible ASCII characters", path.display())
    })?;
    let token = NewToken {
        secret: &secret,
        owner: "admin",
        name: Some("from a file"),
        scope: TokenScope::Admin,
        lifetime_ms: None,
    };
    Ok(store.create_token(&token).await?)
}

fn as_json(token: &TokenRecord, now: i64) -> serde_json::Value {
    json!({
        "id": token.id,
        "owner": token.owner,
        "name": token.name,
        "scope": token.scope.as_str(),
        "state": state(token, now),
        "created": time(token.created),
        "expires": token.expires.map(time),
        "revoked": token.revoked.map(time),
        "last_used": token.last_used.map(time),
    })
}

fn state(token: &TokenRecord, now: i64) -> &'static str {
    match (token.revoked, token.expires) {
        (Some(_), _) => "revoked",
        (None, Some(expires)) if expires <= now => "expired",
        _ => "valid",
    }
}

fn time(milliseconds: i64) -> String {
    // The database's own times are within what a timestamp can hold.
    jiff::Timestamp::from_second(milliseconds / 1000).map_or_else(|_| "?".to_owned(), |time| time.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lifetimes_are_days_hours_or_without_end() {
        assert_eq!("90d".parse(), Ok(Lifetime(Some(90 * 86_400_000))));
        assert_eq!("12h".parse(), Ok(Lifetime(Some(12 * 3_600_000))));
        assert_eq!("never".parse(), Ok(Lifetime(None)));
        for text in ["", "d", "0d", "-1d", "90", "1e9d", "40000d", "soon"] {
            assert!(text.parse::<Lifetime>().is_err(), "{text}");
        }
    }
}
