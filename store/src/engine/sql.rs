//! The statements, each whole in a file of its own: `store/sql/sqlite/` and `store/sql/postgres/`, in each a folder for each module
//! that uses them, and the same files. A file begins with a comment that says what the statement does, what its parameters are and what
//! it gives; these are the same on both engines.
//!
//! The time is the database's: statements read it from the view `clock`. Lists and rows come as one parameter, a JSON array, so
//! that a statement is the same however many they are.

/// A statement without the comment that it begins with, so that logs begin with the statement.
const fn without_comment(file: &'static str) -> &'static str {
    let mut rest = file.as_bytes();
    while let [b'-', b'-', ..] = rest {
        while let [first, tail @ ..] = rest {
            rest = tail;
            if *first == b'\n' {
                break;
            }
        }
    }
    match str::from_utf8(rest) {
        Ok(statement) => statement,
        Err(_) => panic!("a file that is UTF-8 is so after a line break"),
    }
}

macro_rules! statements {
    ($($module:ident { $($name:ident = $file:literal,)+ })+) => {
        $(pub(crate) mod $module {
            use crate::engine::query::Statement;
            $(pub(crate) const $name: Statement = Statement {
                sqlite: super::without_comment(include_str!(concat!(
                    "../../sql/sqlite/",
                    stringify!($module),
                    "/",
                    $file,
                    ".sql"
                ))),
                postgres: super::without_comment(include_str!(concat!(
                    "../../sql/postgres/",
                    stringify!($module),
                    "/",
                    $file,
                    ".sql"
                ))),
            };)+
        })+

        /// All of them, by folder and file.
        #[cfg(test)]
        const ALL: &[(&str, crate::engine::query::Statement)] = &[$($((concat!(stringify!($module), "/", $file), $module::$name),)+)+];
    };
}

statements! {
    census {
        ARTIFACT_BYTES = "artifact_bytes",
        DISAGREEMENTS = "disagreements",
        OLDEST_QUEUED = "oldest_queued",
        SWEEPS = "sweeps",
    }
    check {
        BLOBS = "blobs",
        PAGES = "pages",
        REFERENCES = "references",
        RESULTS = "results",
        WITHOUT_RESULT = "without_result",
    }
    clock {
        NOW = "now",
    }
    collection {
        BEGIN = "begin",
        END = "end",
        LAST = "last",
    }
    event {
        LIST = "list",
        MAKE_DURABLE = "make_durable",
        MARKS = "marks",
        SINCE = "since",
        SWEEPS = "sweeps",
    }
    failure {
        LIST = "list",
    }
    machine {
        KEEP_SPEED = "keep_speed",
        LATEST_SPEED = "latest_speed",
    }
    point {
        ARTIFACTS = "artifacts",
        LIST = "list",
        ONE = "one",
        TABLE = "table",
        WITH_ARTIFACTS = "with_artifacts",
    }
    probe {
        INSERT_SCENARIO = "insert_scenario",
        INSERT_TURN = "insert_turn",
        INSERT_WORK = "insert_work",
    }
    queue {
        BEGIN_TO_LOOK = "begin_to_look",
        CANCEL = "cancel",
        CLAIM = "claim",
        CRASH = "crash",
        DELETE_RESULT = "delete_result",
        DEPTHS = "depths",
        EARLIER_BLOBS = "earlier_blobs",
        EARLIER_RESULT = "earlier_result",
        END_LEASES = "end_leases",
        END_OUTDATED = "end_outdated",
        FAIL = "fail",
        FINISH = "finish",
        FINISH_AND_CLAIM = "finish_and_claim",
        FINISH_AT_ONCE = "finish_at_once",
        INSERT_ARTIFACT = "insert_artifact",
        INSERT_RESULT = "insert_result",
        IS_ANYTHING_DUE = "is_anything_due",
        IS_ANYTHING_OUTDATED = "is_anything_outdated",
        KEEP_CHECKPOINT = "keep_checkpoint",
        KEEP_DISAGREEMENT = "keep_disagreement",
        NOTE_DISAGREEMENT = "note_disagreement",
        NOTE_WORKER = "note_worker",
        OPEN_WORK = "open_work",
        RELEASE = "release",
        RENEW = "renew",
        RETRY_LATER = "retry_later",
        SHORTEN_LEASES = "shorten_leases",
        WAKE = "wake",
    }
    repair {
        MARK = "mark",
        NAMES_BLOB = "names_blob",
        QUEUE = "queue",
        WORK = "work",
        WORKS_OF_BLOB = "works_of_blob",
    }
    retention {
        ARTIFACT_NAMES = "artifact_names",
        BEGIN_REMOVAL = "begin_removal",
        BLOBS_IN_USE = "blobs_in_use",
        DELETE_EVENTS = "delete_events",
        DELETE_IDEMPOTENCY_KEYS = "delete_idempotency_keys",
        DELETE_REMOVALS = "delete_removals",
        DELETE_RESULTS = "delete_results",
        DELETE_SCENARIOS = "delete_scenarios",
        DELETE_SESSIONS = "delete_sessions",
        DELETE_SWEEPS = "delete_sweeps",
        DELETE_TURNS = "delete_turns",
        DELETE_UPLOADS = "delete_uploads",
        DELETE_WORK = "delete_work",
        DELETE_WORKERS = "delete_workers",
        END_REMOVAL = "end_removal",
        EXPIRE_ARTIFACTS = "expire_artifacts",
        IS_BLOB_IN_USE = "is_blob_in_use",
        TRUNCATE_LOG = "truncate_log",
    }
    session {
        CLOSE = "close",
        OPEN = "open",
        TOKEN = "token",
    }
    submit {
        ANALYZE = "analyze",
        APPENDED = "appended",
        COPY_ARTIFACTS = "copy_artifacts",
        COPY_RESULTS = "copy_results",
        COUNT = "count",
        ENDS_OF_ORDER = "ends_of_order",
        EXTENDED_SWEEP = "extended_sweep",
        FULLER_RESULTS = "fuller_results",
        INSERT_APPENDED = "insert_appended",
        INSERT_IDEMPOTENCY_KEY = "insert_idempotency_key",
        INSERT_POINTS = "insert_points",
        INSERT_SCENARIO = "insert_scenario",
        INSERT_SWEEP = "insert_sweep",
        INSERT_TURN = "insert_turn",
        INSERT_WORK = "insert_work",
        KEEP_HIDDEN = "keep_hidden",
        KNOWN_RESULTS = "known_results",
        KNOWN_SWEEP = "known_sweep",
        KNOWN_WORK = "known_work",
        OTHERS_RESULTS = "others_results",
        POINTS_OF = "points_of",
        SET_POINTS = "set_points",
        SHOW = "show",
        VERSION_OF_POINTS = "version_of_points",
    }
    sweep {
        CANCEL = "cancel",
        CANCELLED_TO = "cancelled_to",
        CANCEL_TO = "cancel_to",
        CANCEL_WORK = "cancel_work",
        CHANGE = "change",
        CHANGE_PRIORITY_OF_WORK = "change_priority_of_work",
        COUNT_EVENTS = "count_events",
        DELETABLE = "deletable",
        DELETE = "delete",
        DELETE_EVENTS = "delete_events",
        DELETE_POINTS = "delete_points",
        FORGET_KEYS = "forget_keys",
        HALF_CANCELLED = "half_cancelled",
        HIDE = "hide",
        HOLD_BACK = "hold_back",
        KEEP_RUNNING_WORK = "keep_running_work",
        LAST_POINT = "last_point",
        LEAVE_WORK = "leave_work",
        LEFT_HIDDEN = "left_hidden",
        LIST = "list",
        ONE = "one",
        OWN_RESULTS = "own_results",
        PAUSE = "pause",
        PHYSICS_VERSIONS = "physics_versions",
        RECOUNT = "recount",
        RETRY_WORK = "retry_work",
        REVIVE = "revive",
        STOP_WORK = "stop_work",
        VERSION = "version",
    }
    token {
        CREATE = "create",
        LIST = "list",
        PRESENT = "present",
        REVOKE = "revoke",
        TOUCH = "touch",
        VALID = "valid",
    }
    transfer {
        BLOBS = "blobs",
        COLUMNS = "columns",
        COUNT_BLOBS = "count_blobs",
        RELEASE = "release",
        USERS = "users",
    }
    upload {
        RESERVE = "reserve",
        RESERVE_AT_ONCE = "reserve_at_once",
        UNRESERVED = "unreserved",
    }
    verification {
        LIST = "list",
    }
    worker {
        END_LEASES = "end_leases",
        LIST = "list",
        REGISTER = "register",
        REMOVE = "remove",
        REMOVE_PROCESS = "remove_process",
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::{Path, PathBuf};

    use sqlx::{AssertSqlSafe, Row as _};

    use super::*;
    use crate::engine::database::Database;
    use crate::engine::query::Statement;
    use crate::engine::role::Role;
    use crate::store::{Store, StoreConfig};

    /// Tables and indexes that a plan may scan from end to end, because they are small: tables of a row, a parameter, an owner, a token,
    /// a worker or a machine each, and indexes of the few rows that a statement looks for. A plan may also scan what it has selected
    /// itself.
    const SMALL: &[&str] = &[
        "CONSTANT",
        "clock",
        "collection",
        "json_each",
        "machine_speed",
        "owner_turn",
        "token",
        "worker",
        "work_leased",
        "work_open",
        "work_open_by_version",
        "work_waiting",
        "result_disagrees",
        "sweep_half_cancelled",
        "sweep_hidden",
    ];

    /// The statements that go through anything else from end to end, and what: they count or delete over all, or list the
    /// newest of all.
    const WHOLE: &[(&str, &str)] = &[
        ("census/artifact_bytes", "artifact"),
        ("census/sweeps", "sweep"),
        ("check/blobs", "artifact"),
        ("check/references", "pragma_foreign_key_check"),
        ("check/results", "result"),
        ("check/without_result", "work"),
        ("event/marks", "sweep"),
        ("event/since", "sweep"),
        ("retention/artifact_names", "artifact"),
        ("retention/blobs_in_use", "artifact"),
        ("retention/blobs_in_use", "upload"),
        ("retention/blobs_in_use", "work"),
        ("retention/delete_events", "event"),
        ("retention/delete_idempotency_keys", "idempotency"),
        ("retention/delete_removals", "removal"),
        ("retention/delete_results", "result"),
        ("retention/delete_scenarios", "scenario"),
        ("retention/delete_sessions", "session"),
        ("retention/delete_sweeps", "sweep"),
        ("retention/delete_uploads", "upload"),
        ("retention/delete_work", "work"),
        ("retention/expire_artifacts", "result"),
        ("retention/is_blob_in_use", "work"),
        ("sweep/list", "sweep"),
        ("transfer/blobs", "work"),
        ("transfer/columns", "pragma_table_xinfo"),
        ("transfer/count_blobs", "artifact"),
        ("transfer/count_blobs", "work"),
    ];

    /// An engine: its folder, the sign before the number of a parameter, and its text of a statement.
    type Engine = (&'static str, char, fn(&Statement) -> &'static str);

    const ENGINES: [Engine; 2] =
        [("sqlite", '?', |statement| statement.sqlite), ("postgres", '$', |statement| statement.postgres)];

    fn folder(engine: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("sql").join(engine)
    }

    #[test]
    fn every_file_is_a_statement_and_says_what_its_parameters_are() {
        for (engine, sign, text) in ENGINES {
            let folder = folder(engine);
            let mut files = BTreeSet::new();
            for module in std::fs::read_dir(&folder).unwrap() {
                for file in std::fs::read_dir(module.unwrap().path()).unwrap() {
                    let path = file.unwrap().path().with_extension("");
                    files.insert(path.strip_prefix(&folder).unwrap().to_str().unwrap().to_owned());
                }
            }
            assert_eq!(files, ALL.iter().map(|(name, _)| (*name).to_owned()).collect());
            for (name, statement) in ALL {
                let statement = text(statement);
                let file = std::fs::read_to_string(folder.join(name).with_extension("sql")).unwrap();
                let comment = file.strip_suffix(statement).unwrap();
                assert!(comment.starts_with("-- "), "{engine}: {name} says nothing of itself");
                assert!(!statement.contains("--"), "{engine}: {name} has a comment inside");
                for number in 1..20 {
                    let parameter = format!("{sign}{number}");
                    assert_eq!(
                        names(comment, &parameter),
                        names(statement, &parameter),
                        "{parameter} of {name}"
                    );
                }
            }
        }
    }

    /// Whether a text names a parameter.
    fn names(text: &str, parameter: &str) -> bool {
        text.match_indices(parameter)
            .any(|(at, found)| !text[at + found.len()..].starts_with(|next: char| next.is_ascii_digit()))
    }

    #[test]
    fn a_statement_has_the_same_parameters_on_both_engines() {
        for (name, statement) in ALL {
            for number in 1..20 {
                let (of_sqlite, of_postgres) = (format!("?{number}"), format!("${number}"));
                assert_eq!(
                    names(statement.sqlite, &of_sqlite),
                    names(statement.postgres, &of_postgres),
                    "parameter {number} of {name}"
                );
            }
        }
    }

    #[test]
    fn only_the_clock_tells_the_time() {
        let clocks =
            ["julianday", "unixepoch", "current_timestamp", "strftime", "datetime", "now()", "_timestamp"];
        for (name, statement) in ALL {
            for text in [statement.sqlite, statement.postgres] {
                for word in clocks {
                    assert!(!text.to_lowercase().contains(word), "{name} has another clock");
                }
            }
        }
    }

    #[tokio::test]
    async fn no_statement_reads_a_whole_table_but_those_that_must() {
        let directory = tempfile::tempdir().unwrap();
        let store = Store::open(&StoreConfig::in_directory(directory.path(), Role::Server)).await.unwrap();
        let Database::Sqlite(pool, _) = &store.database else { panic!("a directory has a SQLite file") };
        let mut whole = BTreeSet::new();
        for (name, statement) in ALL {
            let statement = statement.sqlite;
            let plan = format!("EXPLAIN QUERY PLAN {statement}");
            for step in sqlx::query(AssertSqlSafe(plan)).fetch_all(pool).await.unwrap() {
                let step: String = step.get("detail");
                let words: Vec<&str> = step.split(' ').collect();
                if let ["SCAN", table, rest @ ..] = words.as_slice()
                    && !SMALL.contains(table)
                    && !table.starts_with('(')
                    && !statement.contains(&format!(") AS {table}\n"))
                    && !rest.last().is_some_and(|index| SMALL.contains(index))
                {
                    whole.insert((*name, (*table).to_owned()));
                }
            }
        }
        let whole: Vec<(&str, &str)> = whole.iter().map(|(name, table)| (*name, table.as_str())).collect();
        assert_eq!(whole, WHOLE);
    }
}
