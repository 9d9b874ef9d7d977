//! Engines behind the store, a SQLite file or a PostgreSQL server: connections, transactions, schemas and statements.

pub(crate) mod backoff;
pub(crate) mod connections;
pub(crate) mod database;
pub(crate) mod location;
pub(crate) mod migration;
pub(crate) mod notification;
pub(crate) mod postgres;
pub(crate) mod query;
pub(crate) mod role;
pub(crate) mod sql;
pub(crate) mod sqlite;
pub(crate) mod throttle;
