//! Location of the database.

use std::ffi::OsString;
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

impl DatabaseLocation {
    /// The same with a password; none for a file, which has no password.
    #[must_use]
    pub fn with_password(&self, password: &str) -> Option<Self> {
        match self {
            DatabaseLocation::Sqlite(_) => None,
            DatabaseLocation::Postgres(options) => {
                Some(DatabaseLocation::Postgres(Box::new(options.as_ref().clone().password(password))))
            }
        }
    }

    /// As text, with the password: for a process of the same user.
    pub fn with_secrets(&self) -> OsString {
        match self {
            DatabaseLocation::Sqlite(path) => path.clone().into_os_string(),
            DatabaseLocation::Postgres(options) => options.to_url_lossy().as_str().into(),
        }
    }
}

impl FromStr for DatabaseLocation {
    type Err = StoreError;

    fn from_str(text: &str) -> Result<Self, StoreError> {
        if text.starts_with("postgres://") || text.starts_with("postgresql://") {
            return match text.parse() {
                Ok(options) => Ok(DatabaseLocation::Postgres(Box::new(options))),
                Err(error) => {
                    Err(StoreError::Location(format!("not a URL of a PostgreSQL database: {error}")))
                }
            };
        }
        if let Some((scheme, _)) = text.split_once("://") {
            return Err(StoreError::Location(format!(
                "unsupported database scheme {scheme}://: give postgres://user@host/name, or the path of a SQLite file"
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_url_is_a_server_and_all_else_a_file() {
        for url in [
            "postgres://anne:secret@db.example:6432/sweeps",
            "postgresql://anne:secret@db.example:6432/sweeps",
        ] {
            let location: DatabaseLocation = url.parse().unwrap();
            assert_eq!(location.to_string(), "postgres://db.example:6432/sweeps");
            assert!(
                location.with_secrets().to_str().unwrap().contains("anne:secret@"),
                "a child must get in, too"
            );
        }
        let file: DatabaseLocation = "some/where.sqlite".parse().unwrap();
        assert_eq!(file.to_string(), "some/where.sqlite");
        assert!(file.with_password("secret").is_none());
        for other in ["", "mysql://host/name", "postgres://host:port/name"] {
            assert!(matches!(other.parse::<DatabaseLocation>(), Err(StoreError::Location(_))), "{other:?}");
        }
    }
}
