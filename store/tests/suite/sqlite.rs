//! The embedded engine: a SQLite file.

use std::path::PathBuf;

use drillsweep_store::{NewSweep, Role, Store, StoreConfig, StoreError, WorkState};
use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};
use tempfile::TempDir;

use crate::bench::{Engine, submit, sweep, sweep_record};
use crate::place::{Directory, Object, Place};

/// A SQLite file in a directory that does not exist yet, and a place for the objects.
pub(crate) struct Sqlite<P = Directory> {
    temporary: TempDir,
    place: P,
}

impl<P> Sqlite<P> {
    /// The directory of the file.
    pub(crate) fn directory(&self) -> PathBuf {
        self.temporary.path().join("data")
    }
}

impl<P: Place> Engine for Sqlite<P> {
    fn new() -> Self {
        Sqlite { temporary: TempDir::new().unwrap(), place: P::new() }
    }

    fn config(&self, role: Role, clock_offset_ms: i64) -> StoreConfig {
        let mut config =
            StoreConfig::in_directory(&self.directory(), role).with_objects(self.place.location());
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
        ["", "-wal"].iter().any(|suffix| {
            let file = std::fs::read(self.directory().join(format!("drillsweep.sqlite{suffix}"))).unwrap();
            file.windows(bytes.len()).any(|window| window == bytes)
        })
    }
}

/// The database past the store.
async fn database(engine: &Sqlite) -> SqlitePool {
    let file = engine.directory().join("drillsweep.sqlite");
    SqlitePool::connect_with(SqliteConnectOptions::new().filename(file)).await.unwrap()
}

async fn insert_work(database: &SqlitePool, key: &str, state: &str) -> sqlx::Result<()> {
    let statement =
        "INSERT INTO work (key, physics_version, owner, state, priority, vtime, ready_at, created, changed)
                     VALUES (CAST(?1 AS BLOB), 1, 'anne', ?2, 0, 0, 0, 0, 0)";
    sqlx::query(statement).bind(key).bind(state).execute(database).await.map(drop)
}

#[tokio::test]
async fn the_schema_has_the_states_stages_and_transitions_of_work() {
    let engine = Sqlite::<Directory>::new();
    engine.open().await.close().await;
    let database = database(&engine).await;
    for other in ["", "running", "Queued"] {
        assert!(insert_work(&database, other, other).await.is_err(), "{other:?}");
    }
    for from in WorkState::ALL {
        insert_work(&database, from.as_str(), from.as_str()).await.unwrap();
        let (stage, is_open): (String, bool) =
            sqlx::query_as("SELECT stage, is_open FROM work WHERE state = ?1")
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
            let changed = sqlx::query("UPDATE work SET state = ?2 WHERE key = CAST(?1 AS BLOB)")
                .bind(&key)
                .bind(to.as_str())
                .execute(&database)
                .await;
            assert_eq!(changed.is_ok(), from == to || from.may_become(to), "{key}");
        }
    }
}

#[tokio::test]
async fn sweeps_of_an_earlier_schema_get_the_names_of_their_parameters() {
    let engine = Sqlite::<Directory>::new();
    let store = engine.open().await;
    let requests = [
        ("grid", r#"{"axes":{"mud_density":{"values":[1]},"flow_rate":{"from":0,"to":1,"count":2}}}"#),
        (
            "list",
            r#"{"design":"list","points":[{"mud_density":1,"duration":2},{"mud_density":2,"duration":3}]}"#,
        ),
        ("point", r#"{"preset":"paper-200m"}"#),
    ];
    for (id, request) in requests {
        submit(&store, &NewSweep { request_json: request.to_owned(), ..sweep(id, [1]) }).await;
    }
    store.close().await;
    let database = database(&engine).await;
    for change in ["ALTER TABLE sweep DROP COLUMN varied", "DELETE FROM _sqlx_migrations WHERE version = 2"] {
        sqlx::query(change).execute(&database).await.unwrap();
    }
    database.close().await;

    let store = engine.open().await;
    for (id, names) in [
        ("grid", vec!["mud_density", "flow_rate"]),
        ("list", vec!["mud_density", "duration"]),
        ("point", vec![]),
    ] {
        let varied: Vec<String> = serde_json::from_str(&sweep_record(&store, id).await.varied_json).unwrap();
        assert_eq!(varied, names, "{id}");
    }
}

#[tokio::test]
async fn a_database_with_another_schema_is_refused() {
    for change in [
        "UPDATE _sqlx_migrations SET checksum = zeroblob(48)",
        "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time)
         VALUES (999, 'of a later build', true, zeroblob(48), 0)",
    ] {
        let engine = Sqlite::<Directory>::new();
        engine.open().await.close().await;
        engine.open().await.close().await;
        sqlx::query(change).execute(&database(&engine).await).await.unwrap();
        let opened = Store::open(&engine.config(Role::Worker, 0)).await;
        let Err(error @ StoreError::OtherSchema(_)) = opened else { panic!("{change}: {opened:?}") };
        assert!(!error.is_busy() && error.to_string().contains("start with a new database"), "{error}");
    }
}

conformance!(Sqlite);
