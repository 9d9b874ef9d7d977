//! Locations of the data, as arguments of commands.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;
use drillsweep_store::{DatabaseLocation, ObjectsLocation, Role, StoreConfig};
use rustix::fs::Mode;
use tokio::process::Command;

use crate::exposure::{Exposed, database_files, exposed};

/// Locations of the data.
#[derive(Args, Clone)]
pub(crate) struct DataArguments {
    /// Directory of the database and the object store, unless these are elsewhere.
    #[arg(long, value_name = "DIRECTORY", env = "DRILLSWEEP_DATA", default_value = "data")]
    data: PathBuf,
    /// Database: `postgres://user@host/name`, for many machines, or the path of a SQLite file, on a disk of this one;
    /// `drillsweep.sqlite` in the data directory unless given.
    #[arg(long, value_name = "LOCATION", env = "DRILLSWEEP_DATABASE", hide_env_values = true)]
    database: Option<DatabaseLocation>,
    /// Object store, for the tables of results: `s3://BUCKET/PREFIX`, with credentials and endpoint from the environment
    /// (AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_REGION, AWS_ENDPOINT_URL, AWS_ALLOW_HTTP), or a directory; `blobs` in the data
    /// directory unless given.
    #[arg(long, value_name = "LOCATION", env = "DRILLSWEEP_OBJECTS")]
    objects: Option<ObjectsLocation>,
    /// File with the password for the PostgreSQL database.
    #[arg(long, value_name = "FILE", env = "DRILLSWEEP_DATABASE_PASSWORD_FILE")]
    database_password_file: Option<PathBuf>,
    /// File with the credentials for the bucket, in the place of the environment's: the profile `[default]` of a shared credentials
    /// file of AWS (aws_access_key_id, aws_secret_access_key, and aws_session_token if there is one).
    #[arg(long, value_name = "FILE", env = "DRILLSWEEP_OBJECTS_CREDENTIALS_FILE")]
    objects_credentials_file: Option<PathBuf>,
}

impl DataArguments {
    pub(crate) fn store(&self, role: Role) -> anyhow::Result<StoreConfig> {
        // Readers of the files need no token: files that are made from here on are for this user alone.
        rustix::process::umask(Mode::RWXG | Mode::RWXO);
        let mut config = StoreConfig::in_directory(&self.data, role);
        if let Some(database) = &self.database {
            config.database = database.clone();
        }
        if let Some(objects) = &self.objects {
            config.objects = objects.clone();
        }
        if let Some(path) = &self.database_password_file {
            config.database = with_password(&config.database, path, "--database-password-file")?;
        }
        if let Some(path) = &self.objects_credentials_file {
            add_credentials(&mut config.objects, path, "--objects-credentials-file")?;
        }
        Ok(config)
    }

    /// The same for commands that inspect an existing store: they make none.
    pub(crate) fn existing_store(&self, role: Role) -> anyhow::Result<StoreConfig> {
        let config = self.store(role)?;
        anyhow::ensure!(config.exists(), "there is no store in {}", self.data.display());
        Ok(config)
    }

    /// The directory of temporary files unless another one is given.
    pub(crate) fn scratch(&self) -> PathBuf {
        self.data.join("scratch")
    }

    /// Locations, each with its name, without secrets: the data directory as an absolute path, and other locations.
    pub(crate) fn places(&self) -> Vec<(&'static str, String)> {
        let directory = std::path::absolute(&self.data).unwrap_or_else(|_| self.data.clone());
        let mut places = vec![("data", directory.display().to_string())];
        places.extend(self.database.iter().map(|database| ("database", database.to_string())));
        places.extend(self.objects.iter().map(|objects| ("objects", objects.to_string())));
        places
    }

    /// Directories and files of the store to which other users of this machine have access.
    pub(crate) fn exposed(&self, store: &StoreConfig) -> Vec<Exposed> {
        let mut paths = Vec::new();
        if self.database.is_none() || self.objects.is_none() {
            paths.push(self.data.clone());
        }
        if let DatabaseLocation::Sqlite(path) = &store.database {
            paths.extend(database_files(path));
        }
        if let ObjectsLocation::Directory(path) = &store.objects {
            paths.push(path.clone());
        }
        exposed(paths)
    }

    /// Passes it to a process of this program. Secrets are passed by its environment, which only this user can read; arguments are readable
    /// by all users.
    pub(crate) fn hand_on(&self, command: &mut Command) {
        command.arg("--data").arg(&self.data);
        if let Some(database) = &self.database {
            command.env("DRILLSWEEP_DATABASE", database.with_secrets());
        }
        if let Some(objects) = &self.objects {
            command.arg("--objects").arg(objects.to_string());
        }
        if let Some(path) = &self.database_password_file {
            command.arg("--database-password-file").arg(path);
        }
        if let Some(path) = &self.objects_credentials_file {
            command.arg("--objects-credentials-file").arg(path);
        }
    }
}

/// A database with the password from a file that an option names.
pub(crate) fn with_password(
    database: &DatabaseLocation,
    path: &Path,
    option: &str,
) -> anyhow::Result<DatabaseLocation> {
    let password = std::fs::read_to_string(path)
        .with_context(|| format!("the password cannot be read from {}", path.display()))?;
    database
        .with_password(password.trim_end_matches(['\r', '\n']))
        .with_context(|| format!("{option} is for a PostgreSQL database"))
}

/// Gives a bucket the credentials from a file that an option names.
pub(crate) fn add_credentials(
    objects: &mut ObjectsLocation,
    path: &Path,
    option: &str,
) -> anyhow::Result<()> {
    let ObjectsLocation::S3 { settings, .. } = objects else {
        anyhow::bail!("{option} is for a bucket (s3://BUCKET/PREFIX)");
    };
    settings.extend(credentials(path)?);
    Ok(())
}

/// Settings of an object store from the profile `[default]` of a shared credentials file.
fn credentials(path: &Path) -> anyhow::Result<BTreeMap<String, String>> {
    let text = std::fs::read_to_string(path)
        .with_context(|| format!("the object store's credentials cannot be read from {}", path.display()))?;
    parse_credentials(&text).with_context(|| format!("the object store's credentials in {}", path.display()))
}

/// No message repeats the contents of the file, which may be a secret.
fn parse_credentials(text: &str) -> anyhow::Result<BTreeMap<String, String>> {
    const REQUIRED: [&str; 2] = ["aws_access_key_id", "aws_secret_access_key"];
    const OPTIONAL: &str = "aws_session_token";
    let mut settings = BTreeMap::new();
    let mut is_default = false;
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        if line.is_empty() || line.starts_with(['#', ';']) {
            continue;
        }
        if let Some(profile) = line.strip_prefix('[') {
            let name = profile.strip_suffix(']').with_context(|| format!("line {number} lacks a ]"))?;
            is_default = name.trim() == "default";
            continue;
        }
        let (name, value) = line.split_once('=').with_context(|| {
            format!("line {number} is neither a profile, such as [default], nor a name = value")
        })?;
        let name = name.trim().to_ascii_lowercase();
        if is_default && (REQUIRED.contains(&name.as_str()) || name == OPTIONAL) {
            anyhow::ensure!(!value.trim().is_empty(), "line {number} has no value");
            settings.insert(name, value.trim().to_owned());
        }
    }
    for name in REQUIRED {
        anyhow::ensure!(settings.contains_key(name), "the profile [default] has no {name}");
    }
    Ok(settings)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn credentials_are_those_of_the_default_profile() {
        let text = "# of the team\n[other]\naws_access_key_id = other\n\n[default]\r\naws_access_key_id=AKIDEXAMPLE\n\
                    aws_secret_access_key = a+b/c=\nregion = eu-west-1\n[last]\naws_secret_access_key = other\n";
        let settings = parse_credentials(text).unwrap();
        let expected = [("aws_access_key_id", "AKIDEXAMPLE"), ("aws_secret_access_key", "a+b/c=")];
        assert_eq!(settings, expected.map(|(name, value)| (name.to_owned(), value.to_owned())).into());
    }

    #[test]
    fn errors_about_credentials_do_not_contain_them() {
        for (text, reason) in [
            ("", "the profile [default] has no aws_access_key_id"),
            (
                "[default]\naws_access_key_id = verysecret",
                "the profile [default] has no aws_secret_access_key",
            ),
            (
                "aws_access_key_id = verysecret\naws_secret_access_key = verysecret",
                "the profile [default] has no aws_access_key_id",
            ),
            ("[default]\naws_access_key_id =", "line 2 has no value"),
            ("[default\naws_access_key_id = verysecret", "line 1 lacks a ]"),
            ("[default]\nverysecret", "line 2 is neither a profile, such as [default], nor a name = value"),
        ] {
            assert_eq!(parse_credentials(text).unwrap_err().to_string(), reason);
        }
    }
}
