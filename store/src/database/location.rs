//! Where the database is.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use sqlx::ConnectOptions as _;
use sqlx::postgres::PgConnectOptions;

use crate::error::StoreError;

/// A SQLite file, or a PostgreSQL server's database. As text the latter begins with `postgres://`, or `postgresql://`; anything else is
/// a file.
#[derive(Debug, Clone)]
pub enum DatabaseLocation {
    /// A file, on a disk of this machine.
    Sqlite(PathBuf),
    /// A server; what its URL leaves out comes from the environment variables that libpq reads, a password from its file, too.
    Postgres(Box<PgConnectOptions>),
}

impl FromStr for DatabaseLocation {
    type Err = StoreError;

    fn from_str(text: &str) -> Result<Self, StoreError> {
        if text.starts_with("postgres://") || text.starts_with("postgresql://") {
            return match text.parse() {
                Ok(options) => Ok(DatabaseLocation::Postgres(Box::new(options))),
                Err(error) => Err(StoreError::Location(format!("no URL of a PostgreSQL database: {error}"))),
            };
        }
        if let Some((scheme, _)) = text.split_once("://") {
            return Err(StoreError::Location(format!(
                "no database by {scheme}://: give postgres://user@host/name, or the path of a SQLite file"
            )));
        }
        if text.is_empty() {
            return Err(StoreError::Location("the path of the SQLite file is empty".to_owned()));
        }
        Ok(DatabaseLocation::Sqlite(PathBuf::from(text)))
    }
}

impl fmt::Display for DatabaseLocation {
    /// Without the password.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DatabaseLocation::Sqlite(path) => write!(formatter, "{}", path.display()),
            DatabaseLocation::Postgres(options) => {
                let url = options.to_url_lossy();
                write!(formatter, "postgres://{}", url.host_str().unwrap_or("localhost"))?;
                if let Some(port) = url.port() {
                    write!(formatter, ":{port}")?;
                }
                formatter.write_str(url.path())
            }
        }
    }
}
