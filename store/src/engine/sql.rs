//! The statements, from files: `store/sql/MODULE.sql` has those that are the same on both engines, `store/sql/sqlite/MODULE.sql` and
//! `store/sql/postgres/MODULE.sql` have the others, each of them in both. A statement begins with its name (`-- name: NAME`) and a comment
//! on its purpose, its parameters and its columns.
//!
//! The time is the database's: statements read it from the view `clock`. Lists and rows come as one parameter, a JSON array, so
//! that a statement is the same however many they are.

/// Beginning of the line before a statement.
const HEADER: &[u8] = b"-- name: ";

/// Name of a statement, and its text without the comment, so that logs begin with the statement.
type Named = (&'static str, &'static str);

/// Number of statements in a file.
const fn count(file: &str) -> usize {
    let (file, mut at, mut number) = (file.as_bytes(), 0, 0);
    while at < file.len() {
        if has_at(file, at, HEADER) {
            number += 1;
        }
        at = next_line(file, at);
    }
    number
}

/// The statements of a file.
const fn split<const N: usize>(file: &'static str) -> [Named; N] {
    let mut found = [("", ""); N];
    let (bytes, mut at, mut number) = (file.as_bytes(), 0, 0);
    while at < bytes.len() {
        assert!(has_at(bytes, at, HEADER), "a statement has a name before it");
        let name = at + HEADER.len();
        at = next_line(bytes, at);
        let name = part(file, name, at - 1);
        while has_at(bytes, at, b"--") {
            at = next_line(bytes, at);
        }
        let start = at;
        while at < bytes.len() && !has_at(bytes, at, HEADER) {
            at = next_line(bytes, at);
        }
        let is_last = at == bytes.len();
        // A blank line stands between two of them.
        found[number] = (name, part(file, start, if is_last { at } else { at - 1 }));
        number += 1;
    }
    found
}

/// The statement of a name.
const fn find(name: &str, among: &[Named]) -> &'static str {
    let mut number = 0;
    while number < among.len() {
        let (found, statement) = among[number];
        if found.len() == name.len() && has_at(found.as_bytes(), 0, name.as_bytes()) {
            return statement;
        }
        number += 1;
    }
    panic!("no statement has this name")
}

/// True if a text has another one at a position.
const fn has_at(text: &[u8], at: usize, other: &[u8]) -> bool {
    let mut number = 0;
    while number < other.len() {
        if at + number >= text.len() || text[at + number] != other[number] {
            return false;
        }
        number += 1;
    }
    true
}

/// Place after the end of a line.
const fn next_line(text: &[u8], mut at: usize) -> usize {
    while at < text.len() && text[at] != b'\n' {
        at += 1;
    }
    if at < text.len() { at + 1 } else { at }
}

const fn part(text: &'static str, start: usize, end: usize) -> &'static str {
    text.split_at(end).0.split_at(start).1
}

/// A constant for each statement, in a module for each file: `both` are the same on both engines, `each` has a text of its own.
macro_rules! statements {
    ($($module:ident { $(both: $($shared:ident),+;)? $(each: $($own:ident),+;)? })+) => {
        $(pub(crate) mod $module {
            use crate::engine::query::Statement;

            $(
                const FILE: &str = include_str!(concat!("../../sql/", stringify!($module), ".sql"));
                const BOTH: [super::Named; super::count(FILE)] = super::split(FILE);
                $(pub(crate) const $shared: Statement = {
                    let text = super::find(stringify!($shared), &BOTH);
                    Statement { sqlite: text, postgres: text }
                };)+
            )?
            $(
                const SQLITE_FILE: &str = include_str!(concat!("../../sql/sqlite/", stringify!($module), ".sql"));
                const SQLITE: [super::Named; super::count(SQLITE_FILE)] = super::split(SQLITE_FILE);
                const POSTGRES_FILE: &str =
                    include_str!(concat!("../../sql/postgres/", stringify!($module), ".sql"));
                const POSTGRES: [super::Named; super::count(POSTGRES_FILE)] = super::split(POSTGRES_FILE);
                $(pub(crate) const $own: Statement = Statement {
                    sqlite: super::find(stringify!($own), &SQLITE),
                    postgres: super::find(stringify!($own), &POSTGRES),
                };)+
            )?
        })+

        /// All of them, by their paths.
        #[cfg(test)]
        const ALL: &[(&str, crate::engine::query::Statement)] = &[$(
            $($((concat!(stringify!($module), "::", stringify!($shared)), $module::$shared),)+)?
            $($((concat!(stringify!($module), "::", stringify!($own)), $module::$own),)+)?
        )+];
    };
}

statements! {
    census {
        both: ARTIFACT_BYTES, SWEEPS;
        each: DISAGREEMENTS, OLDEST_QUEUED;
    }
    check {
        both: BLOBS, RESULTS, WITHOUT_RESULT;
        each: PAGES, REFERENCES;
    }
    clock {
        both: NOW;
    }
    event {
        each: LIST, MAKE_DURABLE;
    }
    failure {
        each: LIST;
    }
    garbage {
        both: ARTIFACT_NAMES, BEGIN_COLLECTION, BEGIN_REMOVAL, BLOBS_IN_USE, DELETE_EVENTS,
            DELETE_IDEMPOTENCY_KEYS, DELETE_REMOVALS, DELETE_RESERVATIONS, DELETE_RESULTS, DELETE_SESSIONS,
            DELETE_SWEEPS, DELETE_TURNS, DELETE_WORK, DELETE_WORKERS, END_COLLECTION, END_REMOVAL,
            EXPIRE_ARTIFACTS, IS_BLOB_IN_USE, LAST_COLLECTION;
        each: DELETE_SCENARIOS, TRUNCATE_LOG;
    }
    lease {
        both: RENEW;
    }
    machine {
        both: KEEP_SPEED, LATEST_SPEED;
    }
    order {
        both: ENDS_OF_ORDER, INSERT_TURN;
    }
    point {
        both: ARTIFACTS, ONE, TABLE, WITH_ARTIFACTS;
        each: LIST;
    }
    probe {
        both: INSERT_SCENARIO, INSERT_TURN, INSERT_WORK;
    }
    queue {
        both: CANCEL, CRASH, DELETE_RESULT, DEPTHS, EARLIER_BLOBS, EARLIER_RESULT, FAIL, FINISH,
            INSERT_ARTIFACT, INSERT_RESULT, IS_ANYTHING_DUE, KEEP_CHECKPOINT, NOTE_WORKER, OPEN_WORK, RELEASE,
            SHORTEN_LEASES, WAKE;
        each: BEGIN_TO_LOOK, CLAIM, END_LEASES, END_OUTDATED, FINISH_AND_CLAIM, FINISH_AT_ONCE,
            IS_ANYTHING_OUTDATED, KEEP_DISAGREEMENT, NOTE_DISAGREEMENT, RETRY_LATER;
    }
    repair {
        both: MARK, NAMES_BLOB, WORK, WORKS_OF_BLOB;
        each: QUEUE;
    }
    reservation {
        each: RESERVE, RESERVE_AT_ONCE, UNRESERVED;
    }
    session {
        both: CLOSE, OPEN, TOKEN;
    }
    submit {
        both: APPENDED, APPENDED_BYTES, EXTENDED_SWEEP, INSERT_APPENDED, INSERT_IDEMPOTENCY_KEY, INSERT_SCENARIO,
            INSERT_SWEEP, KEEP_HIDDEN, KNOWN_SWEEP, SET_POINTS, SHOW, VERSION_OF_POINTS;
        each: ANALYZE, COPY_ARTIFACTS, COPY_RESULTS, COUNT, FULLER_RESULTS, INSERT_POINTS, INSERT_WORK,
            KNOWN_RESULTS, KNOWN_WORK, OTHERS_RESULTS, POINTS_OF;
    }
    sweep {
        both: CANCEL, CANCEL_TO, CANCEL_WORK, CANCELLED_TO, CHANGE, CHANGE_PRIORITY_OF_WORK, COUNT_EVENTS,
            DELETABLE, DELETE, DELETE_EVENTS, DELETE_POINTS, FORGET_KEYS, HALF_CANCELLED, HIDE, HOLD_BACK,
            KEEP_RUNNING_WORK, LEAVE_WORK, LEFT_HIDDEN, OWN_RESULTS, PAUSE, RECOUNT, REQUEST, REQUEST_BYTES, REVIVE, STOP_WORK,
            VERSION;
        each: LAST_POINT, LIST, ONE, PHYSICS_VERSIONS, RETRY_WORK;
    }
    token {
        both: LIST, PRESENT, REVOKE, TOUCH, VALID;
        each: CREATE;
    }
    transfer {
        both: BLOBS, COUNT_BLOBS, RELEASE, USERS;
        each: COLUMNS;
    }
    verification {
        each: LIST;
    }
    worker {
        both: END_LEASES, LIST, REGISTER, REMOVE, REMOVE_PROCESS;
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};
    use std::path::Path;

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
        ("census::ARTIFACT_BYTES", "artifact"),
        ("census::SWEEPS", "sweep"),
        ("check::BLOBS", "artifact"),
        ("check::REFERENCES", "pragma_foreign_key_check"),
        ("check::RESULTS", "result"),
        ("check::WITHOUT_RESULT", "work"),
        ("garbage::ARTIFACT_NAMES", "artifact"),
        ("garbage::BLOBS_IN_USE", "artifact"),
        ("garbage::BLOBS_IN_USE", "upload"),
        ("garbage::BLOBS_IN_USE", "work"),
        ("garbage::DELETE_EVENTS", "event"),
        ("garbage::DELETE_IDEMPOTENCY_KEYS", "idempotency"),
        ("garbage::DELETE_REMOVALS", "removal"),
        ("garbage::DELETE_RESULTS", "result"),
        ("garbage::DELETE_SCENARIOS", "scenario"),
        ("garbage::DELETE_SESSIONS", "session"),
        ("garbage::DELETE_SWEEPS", "sweep"),
        ("garbage::DELETE_RESERVATIONS", "upload"),
        ("garbage::DELETE_WORK", "work"),
        ("garbage::EXPIRE_ARTIFACTS", "result"),
        ("garbage::IS_BLOB_IN_USE", "work"),
        ("sweep::LIST", "sweep"),
        ("transfer::BLOBS", "work"),
        ("transfer::COLUMNS", "pragma_table_xinfo"),
        ("transfer::COUNT_BLOBS", "artifact"),
        ("transfer::COUNT_BLOBS", "work"),
    ];

    /// An engine: the folder of its own statements, and its text of a statement.
    type Engine = (&'static str, fn(&Statement) -> &'static str);

    const ENGINES: [Engine; 2] =
        [("sqlite", |statement| statement.sqlite), ("postgres", |statement| statement.postgres)];

    /// Comments and texts of the statements in a folder, by their paths.
    fn files(folder: &str) -> BTreeMap<String, (String, String)> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("sql").join(folder);
        let mut found = BTreeMap::new();
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                continue;
            }
            let (module, file) = (path.file_stem().unwrap(), std::fs::read_to_string(&path).unwrap());
            for one in file.split("-- name: ").skip(1) {
                let (name, text) = one.split_once('\n').unwrap();
                let comment: String =
                    text.split_inclusive('\n').take_while(|line| line.starts_with("--")).collect();
                let statement = format!("{}\n", text[comment.len()..].trim_end());
                found.insert(format!("{}::{name}", module.to_str().unwrap()), (comment, statement));
            }
        }
        found
    }

    #[test]
    fn every_statement_of_the_files_is_listed_and_documents_its_parameters() {
        for (engine, text) in ENGINES {
            let mut files = self::files("");
            for (name, statement) in self::files(engine) {
                assert_eq!(files.insert(name, statement), None, "{engine} has a statement of both");
            }
            let listed: BTreeSet<_> = ALL.iter().map(|(name, _)| (*name).to_owned()).collect();
            assert_eq!(files.keys().cloned().collect::<BTreeSet<_>>(), listed);
            for (name, statement) in ALL {
                let (comment, written) = &files[*name];
                let statement = text(statement);
                assert_eq!(statement, written, "{engine}: {name}");
                assert!(comment.starts_with("-- "), "{engine}: {name} says nothing of itself");
                assert!(!statement.contains("--"), "{engine}: {name} has a comment inside");
                for number in 1..20 {
                    assert_eq!(
                        names(comment, number),
                        names(statement, number),
                        "{engine}: ${number} of {name}"
                    );
                }
            }
        }
    }

    /// True if a text names a parameter.
    fn names(text: &str, number: usize) -> bool {
        let parameter = format!("${number}");
        text.match_indices(&parameter)
            .any(|(at, found)| !text[at + found.len()..].starts_with(|next: char| next.is_ascii_digit()))
    }

    #[test]
    fn a_statement_has_the_same_parameters_on_both_engines() {
        for (name, statement) in ALL {
            for number in 1..20 {
                assert_eq!(
                    names(statement.sqlite, number),
                    names(statement.postgres, number),
                    "parameter {number} of {name}"
                );
            }
        }
    }

    #[test]
    fn a_statement_common_to_both_engines_is_written_once() {
        let (sqlite, postgres) = (files("sqlite"), files("postgres"));
        for (name, (_, statement)) in &sqlite {
            assert_ne!(*statement, postgres[name].1, "{name}");
        }
    }

    #[test]
    fn only_the_clock_reads_the_time() {
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
        let listed: BTreeSet<_> = WHOLE.iter().map(|(name, table)| (*name, (*table).to_owned())).collect();
        assert_eq!(whole, listed);
    }
}
