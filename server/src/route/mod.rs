//! Routes, a file for each resource.

pub(crate) mod analysis;
pub(crate) mod cost;
pub(crate) mod events;
pub(crate) mod export;
pub(crate) mod files;
pub(crate) mod forced;
pub(crate) mod health;
pub(crate) mod imports;
pub(crate) mod metrics;
pub(crate) mod mode_shapes;
pub(crate) mod points;
pub(crate) mod quantities;
pub(crate) mod report;
pub(crate) mod results;
pub(crate) mod scenarios;
pub(crate) mod session;
pub(crate) mod snapshots;
pub(crate) mod spectrogram;
pub(crate) mod stability_map;
pub(crate) mod statistics;
pub(crate) mod status;
pub(crate) mod sweeps;
pub(crate) mod torque_drag;
pub(crate) mod verification;
pub(crate) mod waiting;
pub(crate) mod web;
