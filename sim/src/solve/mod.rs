//! Model of a scenario, its equilibrium, its modes, and its motion in time.

pub mod model;
pub mod modes;
pub mod motion;
pub mod run;
pub mod statics;
pub mod step;
