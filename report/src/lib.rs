//! Printable reports: one sweep or one point as a self-contained HTML document of two to four pages A4.
//!
//! A report is a pure function of the data that the service shows elsewhere: judgement, operating window, worst places, accuracy and
//! pictures are those of `api` and `chart`. It has no scripts and loads nothing. All texts are escaped by the template library, which this
//! crate alone uses.

mod accuracy;
mod inputs;
mod page;
mod point;
mod reading;
mod source;
mod sweep;
mod verdict;

pub use inputs::Varied;
pub use page::POLICY;
pub use point::{PointData, point};
pub use sweep::{FailedPoint, MOST_FAILURES, SweepData, WindowData, sweep};
