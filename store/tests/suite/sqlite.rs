//! The embedded engine: a SQLite file and a directory of objects.

use std::os::unix::fs::MetadataExt as _;
use std::path::{Path, PathBuf};

use drillsweep_store::{Role, StoreConfig};
use sqlx::migrate::Migrator;
use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};
use tempfile::TempDir;

use crate::bench::{Engine, Object};

/// A directory that does not exist yet, in a temporary one.
struct Sqlite {
    temporary: TempDir,
}

impl Sqlite {
    fn directory(&self) -> PathBuf {
        self.temporary.path().join("data")
    }

    fn blobs(&self) -> PathBuf {
        self.directory().join("blobs")
    }
}

impl Engine for Sqlite {
    fn new() -> Self {
        Sqlite { temporary: TempDir::new().unwrap() }
    }

    fn config(&self, role: Role, clock_offset_ms: i64) -> StoreConfig {
        let mut config = StoreConfig::in_directory(&self.directory(), role);
        config.clock_offset_ms = clock_offset_ms;
        config
    }

    fn objects(&self) -> Vec<Object> {
        let mut found = Vec::new();
        collect_objects(&self.blobs(), "", &mut found);
        found.sort();
        found
    }

    fn write_object(&self, name: &str, content: &[u8]) {
        let path = self.blobs().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }

    fn delete_object(&self, name: &str) {
        std::fs::remove_file(self.blobs().join(name)).unwrap();
    }

    fn abandon_upload(&self, content: &[u8]) {
        // As `object_store` writes them: beside the object, with a number.
        self.write_object("ab/cd/abcd0123#1", content);
    }

    fn refuse_scratch_objects(&self) {
        // A file where the folder should be stops every user; permissions would not stop root.
        self.write_object("probe", b"");
    }

    fn database_holds(&self, bytes: &[u8]) -> bool {
        ["", "-wal"].iter().any(|suffix| {
            let file = std::fs::read(self.directory().join(format!("drillsweep.sqlite{suffix}"))).unwrap();
            file.windows(bytes.len()).any(|window| window == bytes)
        })
    }
}

fn collect_objects(directory: &Path, prefix: &str, found: &mut Vec<Object>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{prefix}{}", entry.file_name().to_str().unwrap());
        let metadata = entry.metadata().unwrap();
        if metadata.is_dir() {
            collect_objects(&entry.path(), &format!("{name}/"), found);
        } else {
            // A file that is written anew is another one, or was changed later.
            let version = format!("{} {:?}", metadata.ino(), metadata.modified().unwrap());
            found.push(Object { name, bytes: metadata.len(), version });
        }
    }
}

/// A database as the migrations before this one made it.
async fn database_before(migration: i64, directory: &Path) -> SqlitePool {
    let all = sqlx::migrate!("../migrations/sqlite");
    let earlier = all.iter().filter(|one| one.version < migration).cloned().collect();
    std::fs::create_dir_all(directory).unwrap();
    let options =
        SqliteConnectOptions::new().filename(directory.join("drillsweep.sqlite")).create_if_missing(true);
    let pool = SqlitePool::connect_with(options).await.unwrap();
    Migrator { migrations: earlier, ..Migrator::DEFAULT }.run(&pool).await.unwrap();
    pool
}

#[tokio::test]
async fn requests_that_were_in_the_row_of_their_sweep_are_kept() {
    let engine = Sqlite::new();
    let old = database_before(27, &engine.directory()).await;
    for (id, appended) in [("s", r#"[{"added":1},{"added":2}]"#), ("t", "[]")] {
        sqlx::query(
            "INSERT INTO sweep (id, owner, request, priority, points, created, appended) VALUES (?1, '', '{}', 0, 0, 0, ?2)",
        )
        .bind(id)
        .bind(appended)
        .execute(&old)
        .await
        .unwrap();
    }
    old.close().await;
    let store = engine.open().await;
    assert_eq!(store.appended_requests("s", 9).await.unwrap(), [r#"{"added":1}"#, r#"{"added":2}"#]);
    assert_eq!(store.appended_requests("t", 9).await.unwrap(), [""; 0]);
}

conformance!(Sqlite);
