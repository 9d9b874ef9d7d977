//! Plans before runs, summaries and errors after them, studies of several.

pub mod cost;
pub mod ensemble;
pub mod errors;
pub mod finer;
pub mod footprint;
pub mod mesh_estimate;
pub mod plan;
pub mod sensitivity;
pub mod soak;
pub mod starts;
pub mod summary;
