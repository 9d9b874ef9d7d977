//! Cost of accuracy: a work-precision study of a scenario.
//!
//! [`plan`] lists the runs that a study needs, [`Measure`] keeps the reported results of a run (statistics and lines over the
//! windows of a summary), and [`report`] compares. The caller makes the runs and measures their time: this module
//! has no clock.
//!
//! An error is relative to a reference on which two independent methods agree. Members of an ensemble share the bias of their
//! method, and a finer step of the same method may share it too; a result on which an explicit and an implicit method agree is the
//! equations' own. If they do not agree, there is no reference, and the report shows it.

mod compare;
mod interval;
mod measure;
mod plan;
mod report;
mod results;

#[cfg(test)]
mod tests;

pub use measure::Measure;
pub use plan::{PlannedRow, Role, plan};
pub use report::report;
pub use results::{
    Agreement, CostErrors, CostReport, CostRow, LineErrors, NamedLine, NodeAgreement, NodeStatistic,
    Quantity, Recommendation, SpuriousLine, StatisticError, StudyError,
};
