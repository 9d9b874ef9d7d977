//! Where the data lies, as the commands are told.

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use drillsweep_store::{DatabaseLocation, ObjectsLocation, Role, StoreConfig};
use rustix::fs::Mode;
use tokio::process::Command;

/// Where the data lies.
#[derive(Args, Clone)]
pub(crate) struct DataArguments {
    /// Directory of the database and the object store, where these are not elsewhere.
    #[arg(long, env = "DRILLSWEEP_DATA", default_value = "data")]
    data: PathBuf,
    /// Database: `postgres://user@host/name`, for many machines, or the path of a SQLite file, on a disk of this one;
    /// `drillsweep.sqlite` in the data directory unless given.
    #[arg(long, env = "DRILLSWEEP_DATABASE", hide_env_values = true)]
    database: Option<DatabaseLocation>,
    /// Object store, for the tables of results: `s3://BUCKET/PREFIX`, with credentials and endpoint from the environment
    /// (AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_REGION, AWS_ENDPOINT_URL, AWS_ALLOW_HTTP), or a directory; `blobs` in the data
    /// directory unless given.
    #[arg(long, env = "DRILLSWEEP_OBJECTS")]
    objects: Option<ObjectsLocation>,
    /// File with the password for the PostgreSQL database.
    #[arg(long, env = "DRILLSWEEP_DATABASE_PASSWORD_FILE")]
    database_password_file: Option<PathBuf>,
}

impl DataArguments {
    pub(crate) fn store(&self, role: Role) -> anyhow::Result<StoreConfig> {
        // Whoever may read the files needs no token: what is made from here on is for this user alone.
        rustix::process::umask(Mode::RWXG | Mode::RWXO);
        let mut config = StoreConfig::in_directory(&self.data, role);
        if let Some(database) = &self.database {
            config.database = database.clone();
        }
        if let Some(objects) = &self.objects {
            config.objects = objects.clone();
        }
        if let Some(path) = &self.database_password_file {
            let password = std::fs::read_to_string(path)
                .with_context(|| format!("the password cannot be read from {}", path.display()))?;
            let password = password.trim_end_matches(['\r', '\n']);
            config.database = config
                .database
                .with_password(password)
                .context("--database-password-file is for a PostgreSQL database")?;
        }
        Ok(config)
    }

    /// The same for commands that look at what there is: they make no store where there is none.
    pub(crate) fn existing_store(&self, role: Role) -> anyhow::Result<StoreConfig> {
        let config = self.store(role)?;
        anyhow::ensure!(config.exists(), "there is no store in {}", self.data.display());
        Ok(config)
    }

    /// The directory of temporary files unless another one is given.
    pub(crate) fn scratch(&self) -> PathBuf {
        self.data.join("scratch")
    }

    /// Hands it on to a process of this program. What is secret goes by its environment, which only this user can look at; arguments
    /// everybody can.
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
    }
}
