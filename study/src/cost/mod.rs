//! Cost of accuracy: a work-precision study of a scenario.
//!
//! [`plan`] lists the runs that a study needs, [`Measure`] keeps of a run what users read of it (statistics and lines over the
//! windows that a summary has), and [`report`] compares. The runs themselves, and their time, are the caller's: nothing here
//! knows a clock.
//!
//! An error is meant against what two methods of different kind both reach. Members of an ensemble share the bias of their
//! method, and a finer step of the same method may share it too; what an explicit and an implicit method agree on is the
//! equations' own. If they do not agree, there is nothing to compare with, and the report shows it.

mod compare;
mod interval;
mod measure;
mod plan;
mod report;
mod results;
mod row;
mod total;

#[cfg(test)]
mod tests;

pub use measure::Measure;
pub use plan::{PlannedRow, Role, plan};
pub use report::report;
pub use results::{
    Agreement, CostErrors, CostReport, CostRow, LineErrors, MeshLimit, MeshPart, NamedLine, NodeAgreement,
    NodeStatistic, Quantity, Recommendation, SpuriousLine, StatisticError, StoppedBy, StudyError,
    TotalChoice, TotalCost,
};
