//! Evaluation of runs: plans before them, summaries with stated errors after them, studies of several.
//!
//! Pure code over the [simulation](drillsweep_sim), without files, clocks or threads: a caller runs the planned runs, and measures their time.

pub mod cost;
pub mod ensemble;
pub mod errors;
pub mod finer;
pub mod footprint;
pub mod loads;
pub mod mesh_estimate;
pub mod plan;
pub mod sensitivity;
pub mod starts;
pub mod summary;
