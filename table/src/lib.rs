//! Tables of results and the vocabulary that they are written in.
//!
//! A [`Table`] has columns of one length. The meaning of a column's name (symbol, unit, label, the unit in which the oil field
//! reads it) is its [`quantity`](drillsweep_quantity); nothing else in the workspace has units or labels of its own. A table is written as
//! [`json`], [`csv`], [`npz`] and [`parquet`] by these modules, from a [`Source`]: a table in memory, or a part of a stored one, which
//! is then read piece by piece; [`InUnits`] is one in other units than the kept ones.

pub mod csv;
mod error;
mod in_units;
pub mod json;
pub mod npz;
pub mod parquet;
mod source;
mod table;
pub mod tables;

pub use error::TableError;
pub use in_units::InUnits;
pub use source::{Sink, Source};
pub use table::{Column, Table};
