//! A table by its columns, as the database reports them: columns of later versions are copied without a change here. These statements alone
//! are composed at run time.

use futures::stream::BoxStream;
use futures::{StreamExt, TryStreamExt};
use sqlx::{AssertSqlSafe, ColumnIndex, Database, Decode, Row, Type};

use crate::engine::database::Transaction;
use crate::engine::query::{Value, postgres_arguments, query, sqlite_arguments};
use crate::engine::sql;
use crate::error::{Result, StoreError};

/// Rows that are inserted by one statement.
const BATCH: usize = 100;

/// Bytes beyond which a batch has no more rows: a request may have megabytes.
const BATCH_BYTES: usize = 4 << 20;

/// A table that both engines have.
pub(super) struct Table {
    pub(super) name: &'static str,
    /// Columns by name, so that both engines have them in the same order.
    columns: Vec<Column>,
}

struct Column {
    name: String,
    kind: Kind,
    /// Place in the primary key from 1, or 0.
    key: i64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Integer,
    Real,
    /// An integer on SQLite.
    Flag,
    Text,
    Bytes,
}

/// Checksum that distinguishes tables of different content.
#[derive(PartialEq, Eq)]
pub(super) struct Sum {
    pub(super) rows: u64,
    /// Hash of all rows in the order of their keys.
    hash: blake3::Hash,
}

impl Table {
    /// A table of a database; without columns if there is none.
    pub(super) async fn read(name: &'static str, tx: &mut Transaction) -> Result<Self> {
        let columns: Vec<(String, String, i64)> =
            query(sql::transfer::COLUMNS).bind(name).rows(&mut *tx).await?;
        let column = |(name, kind, key): (String, String, i64)| {
            let kind = match kind.as_str() {
                "integer" => Kind::Integer,
                "real" => Kind::Real,
                "flag" => Kind::Flag,
                "bytes" => Kind::Bytes,
                _ => Kind::Text,
            };
            Column { name, kind, key }
        };
        Ok(Self { name, columns: columns.into_iter().map(column).collect() })
    }

    /// True if both have the same columns, of kinds that convert into each other.
    pub(super) fn is_like(&self, other: &Table) -> bool {
        let column = |column: &Column| {
            let kind = if column.kind == Kind::Flag { Kind::Integer } else { column.kind };
            (column.name.clone(), kind, column.key)
        };
        !self.columns.is_empty()
            && self.columns.len() == other.columns.len()
            && self.columns.iter().map(column).eq(other.columns.iter().map(column))
    }

    pub(super) async fn is_empty(&self, tx: &mut Transaction) -> Result<bool> {
        let statement = AssertSqlSafe(format!("SELECT EXISTS (SELECT 1 FROM \"{}\")", self.name));
        let has_rows: bool = match tx {
            Transaction::Sqlite { transaction, .. } => {
                sqlx::query_scalar(statement).fetch_one(&mut **transaction).await?
            }
            Transaction::Postgres(transaction) => {
                sqlx::query_scalar(statement).fetch_one(transaction.connection()).await?
            }
        };
        Ok(!has_rows)
    }

    /// Copies all rows to the table of the same name of another database, and returns the rows read.
    pub(super) async fn copy(
        &self,
        from: &mut Transaction,
        other: &Table,
        to: &mut Transaction,
    ) -> Result<Sum> {
        let mut summing = Summing::new();
        let (mut batch, mut bytes) = (Vec::new(), 0);
        let mut rows = self.rows(from);
        while let Some(row) = rows.try_next().await? {
            summing.add(&row);
            bytes += row.iter().map(size).sum::<usize>();
            batch.push(row);
            if batch.len() == BATCH || bytes >= BATCH_BYTES {
                other.insert(std::mem::take(&mut batch), to).await?;
                bytes = 0;
            }
        }
        other.insert(batch, to).await?;
        Ok(summing.end())
    }

    /// Checksum of the table's content.
    pub(super) async fn sum(&self, tx: &mut Transaction) -> Result<Sum> {
        let mut summing = Summing::new();
        let mut rows = self.rows(tx);
        while let Some(row) = rows.try_next().await? {
            summing.add(&row);
        }
        Ok(summing.end())
    }

    /// All rows in the order of their keys, which is the same on both engines, while they are read.
    fn rows<'c>(&'c self, tx: &'c mut Transaction) -> BoxStream<'c, Result<Vec<Value>>> {
        let mut key: Vec<&Column> = self.columns.iter().filter(|column| column.key > 0).collect();
        key.sort_by_key(|column| column.key);
        let statement = AssertSqlSafe(format!(
            "SELECT {} FROM \"{}\" ORDER BY {}",
            names(self.columns.iter()),
            self.name,
            names(key.into_iter())
        ));
        match tx {
            Transaction::Sqlite { transaction, .. } => {
                let rows = sqlx::query(statement).fetch(&mut **transaction);
                rows.map(|row| self.values(&row?)).boxed()
            }
            Transaction::Postgres(transaction) => {
                let rows = sqlx::query(statement).fetch(transaction.connection());
                rows.map(|row| self.values(&row?)).boxed()
            }
        }
    }

    fn values<'r, R: Row>(&self, row: &'r R) -> Result<Vec<Value>>
    where
        usize: ColumnIndex<R>,
        i64: Readable<'r, R::Database>,
        f64: Readable<'r, R::Database>,
        bool: Readable<'r, R::Database>,
        String: Readable<'r, R::Database>,
        Vec<u8>: Readable<'r, R::Database>,
    {
        let value = |(at, column): (usize, &Column)| {
            Ok(match column.kind {
                Kind::Integer => Value::Integer(row.try_get(at)?),
                Kind::Real => Value::Real(row.try_get(at)?),
                Kind::Flag => Value::Flag(row.try_get(at)?),
                Kind::Text => Value::Text(row.try_get(at)?),
                Kind::Bytes => Value::Bytes(row.try_get(at)?),
            })
        };
        self.columns.iter().enumerate().map(value).collect()
    }

    async fn insert(&self, rows: Vec<Vec<Value>>, tx: &mut Transaction) -> Result<()> {
        if rows.is_empty() {
            return Ok(());
        }
        let mut numbers = 1..;
        let row = || {
            let numbers: Vec<String> =
                numbers.by_ref().take(self.columns.len()).map(|number: usize| format!("${number}")).collect();
            format!("({})", numbers.join(", "))
        };
        let places = std::iter::repeat_with(row).take(rows.len()).collect::<Vec<_>>().join(", ");
        let statement = AssertSqlSafe(format!(
            "INSERT INTO \"{}\" ({}) VALUES {places}",
            self.name,
            names(self.columns.iter())
        ));
        let kinds = self.columns.iter().map(|column| column.kind).cycle();
        let values =
            rows.into_iter().flatten().zip(kinds).map(|(value, kind)| as_kind(value, kind)).collect();
        match tx {
            Transaction::Sqlite { transaction, .. } => {
                let arguments = sqlite_arguments(values)?;
                sqlx::query_with(statement, arguments).execute(&mut **transaction).await.map(drop)
            }
            Transaction::Postgres(transaction) => {
                let arguments = postgres_arguments(values)?;
                sqlx::query_with(statement, arguments).execute(transaction.connection()).await.map(drop)
            }
        }
        .map_err(StoreError::from)
    }
}

/// Type that a column can be read as, by one engine.
trait Readable<'r, D: Database>: Decode<'r, D> + Type<D> {}

impl<'r, D: Database, T: Decode<'r, D> + Type<D>> Readable<'r, D> for T {}

/// Columns as a statement lists them.
fn names<'a>(columns: impl Iterator<Item = &'a Column>) -> String {
    columns.map(|column| format!("\"{}\"", column.name)).collect::<Vec<_>>().join(", ")
}

/// A value as a column of the other engine holds it.
fn as_kind(value: Value, kind: Kind) -> Value {
    match (value, kind) {
        (Value::Integer(value), Kind::Flag) => Value::Flag(value.map(|value| value != 0)),
        (Value::Flag(value), Kind::Integer) => Value::Integer(value.map(i64::from)),
        (value, _) => value,
    }
}

/// Bytes of a value, about.
fn size(value: &Value) -> usize {
    match value {
        Value::Text(Some(text)) => text.len(),
        Value::Bytes(Some(bytes)) => bytes.len(),
        _ => size_of::<Value>(),
    }
}

/// A sum that is being taken.
struct Summing {
    rows: u64,
    hasher: blake3::Hasher,
}

impl Summing {
    fn new() -> Self {
        Self { rows: 0, hasher: blake3::Hasher::new() }
    }

    fn add(&mut self, row: &[Value]) {
        self.rows += 1;
        for value in row {
            match value {
                Value::Integer(value) => self.add_value(b'i', value.map(i64::to_le_bytes)),
                Value::Real(value) => self.add_value(b'r', value.map(f64::to_le_bytes)),
                // As SQLite has it.
                Value::Flag(value) => self.add_value(b'i', value.map(|value| i64::from(value).to_le_bytes())),
                Value::Text(value) => self.add_value(b't', value.as_ref()),
                Value::Bytes(value) => self.add_value(b'b', value.as_ref()),
            }
        }
    }

    /// Adds a value; an absent one differs from an empty one.
    fn add_value(&mut self, kind: u8, value: Option<impl AsRef<[u8]>>) {
        let length = value.as_ref().map_or(u64::MAX, |value| value.as_ref().len() as u64);
        self.hasher.update(&[kind]).update(&length.to_le_bytes());
        if let Some(value) = value {
            self.hasher.update(value.as_ref());
        }
    }

    fn end(self) -> Sum {
        Sum { rows: self.rows, hash: self.hasher.finalize() }
    }
}
