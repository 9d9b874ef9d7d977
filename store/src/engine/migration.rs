//! The schemas and what changed in them, from `migrations/`: a folder for each engine.

use std::collections::HashMap;

use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::{PgPool, SqlStr};

use crate::error::Result;

/// Version and description of a migration, which are its file's name, and its text.
type File = (i64, &'static str, &'static str);

const SQLITE: &[File] = &[
    (1, "schema", include_str!("../../../migrations/sqlite/0001_schema.sql")),
    (2, "varied", include_str!("../../../migrations/sqlite/0002_varied.sql")),
];

const POSTGRES: &[File] = &[
    (1, "schema", include_str!("../../../migrations/postgres/0001_schema.sql")),
    (2, "varied", include_str!("../../../migrations/postgres/0002_varied.sql")),
];

/// All migrations of SQLite, to be run on a database: those that it has not had are applied, in the order of their versions. A
/// database that has had one of another text, or one that is not here, is refused.
pub(crate) fn sqlite() -> Migrator {
    migrator(SQLITE)
}

/// The same of PostgreSQL.
pub(crate) fn postgres() -> Migrator {
    migrator(POSTGRES)
}

/// True if a PostgreSQL database has had all migrations and no others, so that nothing has to be written: a worker's role may not.
pub(crate) async fn is_current(pool: &PgPool) -> Result<bool> {
    let exists: bool =
        sqlx::query_scalar("SELECT to_regclass('_sqlx_migrations') IS NOT NULL").fetch_one(pool).await?;
    if !exists {
        return Ok(false);
    }
    let applied: Vec<(i64, Vec<u8>)> =
        sqlx::query_as("SELECT version, checksum FROM _sqlx_migrations WHERE success")
            .fetch_all(pool)
            .await?;
    let applied: HashMap<i64, Vec<u8>> = applied.into_iter().collect();
    let migrator = postgres();
    Ok(applied.len() == migrator.iter().count()
        && migrator.iter().all(|one| applied.get(&one.version).is_some_and(|sum| **sum == *one.checksum)))
}

fn migrator(files: &[File]) -> Migrator {
    let migration = |(version, description, text): &File| {
        Migration::new(
            *version,
            (*description).into(),
            MigrationType::Simple,
            SqlStr::from_static(text),
            false,
        )
    };
    Migrator::with_migrations(files.iter().map(migration).collect())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[tokio::test]
    async fn every_file_is_a_migration() {
        let of = |migrator: &Migrator| -> Vec<_> {
            let parts = |one: &Migration| {
                let text = one.sql.as_str().to_owned();
                (
                    one.version,
                    one.description.clone(),
                    one.migration_type,
                    text,
                    one.checksum.clone(),
                    one.no_tx,
                )
            };
            migrator.iter().map(parts).collect()
        };
        for (engine, migrator) in [("sqlite", sqlite()), ("postgres", postgres())] {
            let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../migrations").join(engine);
            let files = std::fs::read_dir(&folder).unwrap().count();
            let read = Migrator::new(folder.as_path()).await.unwrap();
            assert_eq!(read.iter().count(), files);
            assert_eq!(of(&migrator), of(&read));
        }
    }
}
