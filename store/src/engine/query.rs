//! Statements with their parameters, run on whichever engine there is.
//!
//! A statement has a text for each engine, often the same, and the same parameters and columns on all of them. Both engines are compiled in: which
//! one it is, is known only when the store is opened.
//!
//! Functions that run a statement return boxed futures, which are not generic: sqlx's code for both engines is then compiled with this
//! crate, and not once more with every crate that waits for one of its functions.

use futures::future::BoxFuture;
use sqlx::postgres::{PgArguments, PgQueryResult, PgRow};
use sqlx::sqlite::{SqliteArguments, SqliteQueryResult, SqliteRow};
use sqlx::{
    Arguments as _, Decode, FromRow, PgConnection, Postgres, Row as _, Sqlite, SqliteConnection, SqlitePool,
    Type,
};

use crate::engine::connections::Connections;
use crate::error::Result;

/// Rows of one statement: enough that the calls do not count.
pub(crate) const ROWS_AT_ONCE: usize = 1_000;

/// A statement in the words of each engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Statement {
    pub(crate) sqlite: &'static str,
    pub(crate) postgres: &'static str,
}

/// Begins a query; its parameters follow in the order of their numbers.
pub(crate) fn query(statement: Statement) -> Query {
    Query { statement, parameters: Vec::new() }
}

/// A statement and its parameters.
#[derive(Debug)]
pub(crate) struct Query {
    statement: Statement,
    parameters: Vec<Value>,
}

/// Connection or transaction in which a query runs.
pub(crate) enum Session<'c> {
    Sqlite(&'c mut SqliteConnection),
    /// On any connection, in a transaction of its own.
    SqlitePool(&'c SqlitePool),
    Postgres(&'c mut PgConnection),
    /// On any connection, in a transaction of its own.
    PostgresAny(&'c Connections),
}

/// A parameter. An absent one has a type, too, which PostgreSQL requires.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    Integer(Option<i64>),
    Real(Option<f64>),
    Flag(Option<bool>),
    Text(Option<String>),
    Bytes(Option<Vec<u8>>),
}

/// A row of either engine, whose columns are read by name.
pub(crate) enum Row {
    Sqlite(SqliteRow),
    Postgres(PgRow),
}

/// Type that a row can be read as on either engine: a tuple of columns.
pub(crate) trait Record:
    for<'r> FromRow<'r, SqliteRow> + for<'r> FromRow<'r, PgRow> + Send + Unpin
{
}

impl<T> Record for T where T: for<'r> FromRow<'r, SqliteRow> + for<'r> FromRow<'r, PgRow> + Send + Unpin {}

/// Type that a column can be read as on either engine.
pub(crate) trait Column:
    for<'r> Decode<'r, Sqlite> + Type<Sqlite> + for<'r> Decode<'r, Postgres> + Type<Postgres>
{
}

impl<T> Column for T where
    T: for<'r> Decode<'r, Sqlite> + Type<Sqlite> + for<'r> Decode<'r, Postgres> + Type<Postgres>
{
}

/// Runs one of sqlx's queries on the session's engine.
macro_rules! run {
    ($query:expr, $session:expr, $method:ident, $then:expr) => {{
        let Query { statement, parameters } = $query;
        match $session {
            Session::Sqlite(connection) => {
                let query = sqlx::query_with(statement.sqlite, sqlite_arguments(parameters)?);
                $then(query.$method(connection).await?)
            }
            Session::SqlitePool(pool) => {
                let query = sqlx::query_with(statement.sqlite, sqlite_arguments(parameters)?);
                $then(query.$method(pool).await?)
            }
            Session::Postgres(connection) => {
                let query = sqlx::query_with(statement.postgres, postgres_arguments(parameters)?);
                $then(query.$method(connection).await?)
            }
            Session::PostgresAny(connections) => {
                let query = sqlx::query_with(statement.postgres, postgres_arguments(parameters)?);
                let mut lent = connections.lend().await?;
                let answer = query.$method(&mut *lent).await?;
                lent.give_back();
                $then(answer)
            }
        }
    }};
}

fn execute(query: Query, session: Session<'_>) -> BoxFuture<'_, Result<u64>> {
    Box::pin(async move { Ok(run!(query, session, execute, Changed::rows)) })
}

/// All rows of a statement: it then runs to its commit, and an error of that is seen.
fn fetch(query: Query, session: Session<'_>) -> BoxFuture<'_, Result<Vec<Row>>> {
    Box::pin(async move { Ok(run!(query, session, fetch_all, Row::all)) })
}

impl Query {
    /// Adds the next parameter.
    pub(crate) fn bind(mut self, parameter: impl Into<Value>) -> Self {
        self.parameters.push(parameter.into());
        self
    }

    /// Runs it, and returns the number of changed rows.
    pub(crate) async fn execute<'c>(self, session: impl Into<Session<'c>>) -> Result<u64> {
        execute(self, session.into()).await
    }

    /// Runs it and gives its rows.
    pub(crate) async fn rows<'c, T: Record>(self, session: impl Into<Session<'c>>) -> Result<Vec<T>> {
        fetch(self, session.into()).await?.iter().map(Row::record).collect()
    }

    /// Runs it and gives its rows, each read by the names of its columns.
    pub(crate) async fn records<'c, T>(
        self,
        session: impl Into<Session<'c>>,
        read: impl Fn(&Row) -> Result<T>,
    ) -> Result<Vec<T>> {
        fetch(self, session.into()).await?.iter().map(read).collect()
    }

    /// Runs a statement that gives one row, or none: the first, read by the names of its columns.
    pub(crate) async fn first_record<'c, T>(
        self,
        session: impl Into<Session<'c>>,
        read: impl Fn(&Row) -> Result<T>,
    ) -> Result<Option<T>> {
        Ok(self.records(session, read).await?.into_iter().next())
    }

    /// Runs a statement that gives one row, or none: the first.
    pub(crate) async fn first<'c, T: Record>(self, session: impl Into<Session<'c>>) -> Result<Option<T>> {
        Ok(self.rows(session).await?.into_iter().next())
    }

    /// Runs a statement that gives one row.
    pub(crate) async fn one<'c, T: Record>(self, session: impl Into<Session<'c>>) -> Result<T> {
        self.first(session).await?.ok_or_else(|| sqlx::Error::RowNotFound.into())
    }

    /// Runs it and gives the first column of its rows.
    pub(crate) async fn scalars<'c, T>(self, session: impl Into<Session<'c>>) -> Result<Vec<T>>
    where
        (T,): Record,
    {
        Ok(self.rows::<(T,)>(session).await?.into_iter().map(|(value,)| value).collect())
    }

    /// Runs a statement that gives one row, or none: the first column of the first.
    pub(crate) async fn first_scalar<'c, T>(self, session: impl Into<Session<'c>>) -> Result<Option<T>>
    where
        (T,): Record,
    {
        Ok(self.first::<(T,)>(session).await?.map(|(value,)| value))
    }

    /// Runs a statement that gives one row: its first column.
    pub(crate) async fn scalar<'c, T>(self, session: impl Into<Session<'c>>) -> Result<T>
    where
        (T,): Record,
    {
        Ok(self.one::<(T,)>(session).await?.0)
    }
}

impl Row {
    /// A column by its name.
    pub(crate) fn get<T: Column>(&self, name: &'static str) -> Result<T> {
        Ok(match self {
            Row::Sqlite(row) => row.try_get(name)?,
            Row::Postgres(row) => row.try_get(name)?,
        })
    }

    /// All of its columns.
    fn record<T: Record>(&self) -> Result<T> {
        Ok(match self {
            Row::Sqlite(row) => T::from_row(row)?,
            Row::Postgres(row) => T::from_row(row)?,
        })
    }

    fn all<R: Into<Row>>(rows: Vec<R>) -> Vec<Row> {
        rows.into_iter().map(Into::into).collect()
    }
}

impl From<SqliteRow> for Row {
    fn from(row: SqliteRow) -> Self {
        Row::Sqlite(row)
    }
}

impl From<PgRow> for Row {
    fn from(row: PgRow) -> Self {
        Row::Postgres(row)
    }
}

/// Result of a statement without rows.
trait Changed {
    /// Number of changed rows.
    fn rows(self) -> u64;
}

impl Changed for SqliteQueryResult {
    fn rows(self) -> u64 {
        self.rows_affected()
    }
}

impl Changed for PgQueryResult {
    fn rows(self) -> u64 {
        self.rows_affected()
    }
}

pub(crate) fn sqlite_arguments(parameters: Vec<Value>) -> Result<SqliteArguments> {
    let mut arguments = SqliteArguments::default();
    for parameter in parameters {
        match parameter {
            Value::Integer(value) => arguments.add(value),
            Value::Real(value) => arguments.add(value),
            Value::Flag(value) => arguments.add(value),
            Value::Text(value) => arguments.add(value),
            Value::Bytes(value) => arguments.add(value),
        }
        .map_err(sqlx::Error::Encode)?;
    }
    Ok(arguments)
}

pub(crate) fn postgres_arguments(parameters: Vec<Value>) -> Result<PgArguments> {
    let mut arguments = PgArguments::default();
    for parameter in parameters {
        match parameter {
            Value::Integer(value) => arguments.add(value),
            Value::Real(value) => arguments.add(value),
            Value::Flag(value) => arguments.add(value),
            Value::Text(value) => arguments.add(value),
            Value::Bytes(value) => arguments.add(value),
        }
        .map_err(sqlx::Error::Encode)?;
    }
    Ok(arguments)
}

impl From<i64> for Value {
    fn from(value: i64) -> Self {
        Value::Integer(Some(value))
    }
}

impl From<Option<i64>> for Value {
    fn from(value: Option<i64>) -> Self {
        Value::Integer(value)
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Value::Real(Some(value))
    }
}

impl From<bool> for Value {
    fn from(value: bool) -> Self {
        Value::Flag(Some(value))
    }
}

impl From<Option<bool>> for Value {
    fn from(value: Option<bool>) -> Self {
        Value::Flag(value)
    }
}

impl From<&str> for Value {
    fn from(value: &str) -> Self {
        Value::Text(Some(value.to_owned()))
    }
}

impl From<&String> for Value {
    fn from(value: &String) -> Self {
        Value::Text(Some(value.clone()))
    }
}

impl From<String> for Value {
    fn from(value: String) -> Self {
        Value::Text(Some(value))
    }
}

impl From<Option<&str>> for Value {
    fn from(value: Option<&str>) -> Self {
        Value::Text(value.map(str::to_owned))
    }
}

impl From<Option<String>> for Value {
    fn from(value: Option<String>) -> Self {
        Value::Text(value)
    }
}

impl From<&[u8]> for Value {
    fn from(value: &[u8]) -> Self {
        Value::Bytes(Some(value.to_owned()))
    }
}
