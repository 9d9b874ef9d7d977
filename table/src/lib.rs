//! Tables of results and the vocabulary that they are written in.
//!
//! A [`Table`] has columns of one length. What a column's name stands for (symbol, unit, label, the unit in which the oil field
//! reads it) says its [`quantity`]; nothing else in the workspace has units or labels of its own. A table is written as JSON by
//! serde, and as [`csv`], [`npz`] and [`parquet`] by these modules.

pub mod csv;
pub mod npz;
pub mod parquet;
pub mod quantity;
mod table;

pub use quantity::{Quantity, Unit, Units};
pub use table::{Column, Table};
