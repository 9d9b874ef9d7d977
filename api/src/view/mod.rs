//! Views of results: pure functions from the columns of a run's tables to the requested form.

pub mod history;
pub mod node;
pub mod operating_window;
pub mod orbit;
pub mod points;
pub mod snapshots;
pub mod spectrogram;
pub mod spectrum;
pub mod statistics;
pub mod verification;
pub mod window;
pub mod worst;
