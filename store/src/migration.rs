//! The schema and what changed in it, from `migrations/sqlite/`.

use sqlx::SqlStr;
use sqlx::migrate::{Migration, MigrationType, Migrator};

/// The migrations: version and description, which are the file's name, and its text.
const FILES: &[(i64, &str, &str)] = &[
    (1, "schema", include_str!("../../migrations/sqlite/0001_schema.sql")),
    (2, "worker note", include_str!("../../migrations/sqlite/0002_worker_note.sql")),
];

/// All migrations, to be run on a database: those that it has not had are applied, in the order of their versions. A database
/// that has had one of another text, or one that is not here, is refused.
pub(crate) fn migrations() -> Migrator {
    let migration = |(version, description, text): &(i64, &'static str, &'static str)| {
        Migration::new(
            *version,
            (*description).into(),
            MigrationType::Simple,
            SqlStr::from_static(text),
            false,
        )
    };
    Migrator::with_migrations(FILES.iter().map(migration).collect())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[tokio::test]
    async fn every_file_is_a_migration() {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../migrations/sqlite"));
        let files = std::fs::read_dir(folder).unwrap().count();
        let read = Migrator::new(folder).await.unwrap();
        assert_eq!(read.iter().count(), files);
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
        assert_eq!(of(&migrations()), of(&read));
    }
}
