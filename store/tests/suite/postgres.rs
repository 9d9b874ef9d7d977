//! The engine for many machines: a PostgreSQL server, and a directory of objects.

use std::collections::BTreeMap;
use std::path::Path;

use drillsweep_store::{Role, Store, StoreConfig, StoreError, WorkState};
use sqlx::postgres::PgPool;
use tempfile::TempDir;

use crate::bench::{Engine, claim, submit, sweep};
use crate::place::{Directory, Object, Place};
use crate::servers::postgres::Server;

/// A server with nothing in it, and a place for the objects.
pub(crate) struct Postgres<P = Directory> {
    server: Server,
    temporary: TempDir,
    place: P,
}

impl<P> Postgres<P> {
    /// The database past the store.
    async fn database(&self) -> PgPool {
        PgPool::connect(&self.server.url()).await.unwrap()
    }
}

impl<P: Place> Engine for Postgres<P> {
    fn new() -> Self {
        Postgres { server: Server::start(), temporary: TempDir::new().unwrap(), place: P::new() }
    }

    fn config(&self, role: Role, clock_offset_ms: i64) -> StoreConfig {
        let mut config = StoreConfig::in_directory(self.temporary.path(), role);
        config.database = self.server.url().parse().unwrap();
        config.objects = self.place.location();
        config.clock_offset_ms = clock_offset_ms;
        config
    }

    fn objects(&self) -> Vec<Object> {
        self.place.objects()
    }

    fn write_object(&self, name: &str, content: &[u8]) {
        self.place.write_object(name, content);
    }

    fn delete_object(&self, name: &str) {
        self.place.delete_object(name);
    }

    fn database_holds(&self, bytes: &[u8]) -> bool {
        holds(&self.server.data(), bytes)
    }
}

/// Whether a file in a directory or below has these bytes.
fn holds(directory: &Path, bytes: &[u8]) -> bool {
    std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).any(|path| {
        if path.is_dir() {
            return holds(&path, bytes);
        }
        // The server deletes files whenever it likes.
        std::fs::read(&path).is_ok_and(|file| file.windows(bytes.len()).any(|window| window == bytes))
    })
}

async fn insert_work(database: &PgPool, key: &str, state: &str) -> sqlx::Result<()> {
    let statement =
        "INSERT INTO work (key, physics_version, owner, state, priority, vtime, ready_at, created, changed)
                     VALUES (convert_to($1, 'UTF8'), 1, 'anne', $2, 0, 0, 0, 0, 0)";
    sqlx::query(statement).bind(key).bind(state).execute(database).await.map(drop)
}

#[tokio::test]
async fn the_schema_has_the_states_stages_and_transitions_of_work() {
    let engine = <Postgres>::new();
    engine.open().await.close().await;
    let database = engine.database().await;
    for other in ["", "running", "Queued"] {
        assert!(insert_work(&database, other, other).await.is_err(), "{other:?}");
    }
    for from in WorkState::ALL {
        insert_work(&database, from.as_str(), from.as_str()).await.unwrap();
        let (stage, is_open): (String, bool) =
            sqlx::query_as("SELECT stage, is_open FROM work WHERE state = $1")
                .bind(from.as_str())
                .fetch_one(&database)
                .await
                .unwrap();
        assert_eq!(stage, from.stage().as_str(), "{from:?}");
        assert_eq!(is_open, from.stage().is_open(), "{from:?}");
    }
    for from in WorkState::ALL {
        for to in WorkState::ALL {
            let key = format!("{} to {}", from.as_str(), to.as_str());
            insert_work(&database, &key, from.as_str()).await.unwrap();
            let changed = sqlx::query("UPDATE work SET state = $2 WHERE key = convert_to($1, 'UTF8')")
                .bind(&key)
                .bind(to.as_str())
                .execute(&database)
                .await;
            assert_eq!(changed.is_ok(), from == to || from.may_become(to), "{key}");
        }
    }
}

#[tokio::test]
async fn a_database_with_another_schema_is_refused() {
    for change in [
        "UPDATE _sqlx_migrations SET checksum = ''",
        "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time)
         VALUES (999, 'of a later build', true, '', 0)",
    ] {
        let engine = <Postgres>::new();
        engine.open().await.close().await;
        engine.open().await.close().await;
        sqlx::query(change).execute(&engine.database().await).await.unwrap();
        let opened = Store::open(&engine.config(Role::Worker, 0)).await;
        assert!(matches!(opened, Err(StoreError::Migration(_))), "{change}");
    }
}

#[tokio::test]
async fn who_waits_hears_of_work_and_of_changes_that_another_process_makes() {
    let engine = <Postgres>::new();
    let (waiting, other) = (engine.open().await, engine.open().await);
    let (mut work, mut sweeps) = (waiting.work_changes().await, waiting.sweep_changes().await);
    // Nobody looks by himself within this time: what ends the wait is that somebody tells.
    let look = std::time::Duration::from_secs(36_000);
    let mut heard = Box::pin(async { tokio::join!(work.wait(look), sweeps.wait(look)) });
    let mut number = 0;
    // Again and again, for it takes a moment until somebody listens.
    while tokio::time::timeout(std::time::Duration::from_millis(100), &mut heard).await.is_err() {
        number += 1;
        assert!(number < 300, "nobody heard of anything");
        submit(&other, &sweep(&format!("s{number}"), [number])).await;
        claim(&other, "w").await;
    }
    drop(heard);
    waiting.close().await;
}

/// A table's columns: name, type, whether it may be absent.
type Columns = Vec<(String, String, bool)>;

#[tokio::test]
async fn both_engines_have_the_same_tables_columns_and_indexes() {
    let engine = <Postgres>::new();
    engine.open().await.close().await;
    let postgres = engine.database().await;
    let file = TempDir::new().unwrap();
    Store::open(&StoreConfig::in_directory(file.path(), Role::Server)).await.unwrap().close().await;
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(file.path().join("drillsweep.sqlite"));
    let sqlite = sqlx::SqlitePool::connect_with(options).await.unwrap();

    let rows: Vec<(String, String, String, bool)> = sqlx::query_as(
        "SELECT m.name, c.name, c.type, c.\"notnull\" = 0 FROM sqlite_schema m, pragma_table_xinfo(m.name) c
         WHERE m.type = 'table' AND m.name NOT LIKE '\\_sqlx%' ESCAPE '\\' AND m.name NOT LIKE 'sqlite\\_%' ESCAPE '\\'",
    )
    .fetch_all(&sqlite)
    .await
    .unwrap();
    let of_sqlite = tables(rows);
    let rows: Vec<(String, String, String, bool)> = sqlx::query_as(
        "SELECT table_name::text, column_name::text, data_type::text, is_nullable = 'YES'
         FROM information_schema.columns JOIN information_schema.tables USING (table_schema, table_name)
         WHERE table_schema = 'public' AND table_type = 'BASE TABLE' AND table_name NOT LIKE '\\_sqlx%'",
    )
    .fetch_all(&postgres)
    .await
    .unwrap();
    assert_eq!(tables(rows), of_sqlite);
    assert!(of_sqlite.len() > 10, "{of_sqlite:?}");

    let mut of_sqlite: Vec<(String, String)> =
        sqlx::query_as("SELECT tbl_name, name FROM sqlite_schema WHERE type = 'index' AND sql IS NOT NULL")
            .fetch_all(&sqlite)
            .await
            .unwrap();
    let mut of_postgres: Vec<(String, String)> = sqlx::query_as(
        "SELECT tablename::text, indexname::text FROM pg_indexes
         WHERE schemaname = 'public' AND indexname NOT LIKE '%\\_pkey' AND indexname NOT LIKE '%\\_key'",
    )
    .fetch_all(&postgres)
    .await
    .unwrap();
    of_sqlite.sort();
    of_postgres.sort();
    assert_eq!(of_postgres, of_sqlite);
}

/// Columns by table, their types by what they hold: an engine's own words are not compared. SQLite has no type for yes and no.
fn tables(rows: Vec<(String, String, String, bool)>) -> BTreeMap<String, Columns> {
    let mut tables: BTreeMap<String, Columns> = BTreeMap::new();
    for (table, column, kind, is_nullable) in rows {
        let kind = match kind.to_lowercase().as_str() {
            "integer" | "bigint" | "boolean" => "integer",
            "real" | "double precision" => "real",
            "blob" | "bytea" => "bytes",
            "text" => "text",
            other => panic!("{table}.{column} is of type {other}"),
        };
        tables.entry(table).or_default().push((column, kind.to_owned(), is_nullable));
    }
    tables.values_mut().for_each(|columns| columns.sort());
    tables
}

conformance!(Postgres);
