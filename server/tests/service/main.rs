//! The service over a real store, without the network but where shutting down is the matter.

#![expect(clippy::unwrap_used, reason = "in a test a failure is a panic")]

mod bench;
mod connections;
mod control;
mod damage;
mod errors;
mod events;
mod files;
mod follow;
mod imports;
mod large;
mod limits;
mod log;
mod openapi;
mod page;
mod pictures;
mod refinement;
mod report;
mod results;
mod schema;
mod shutdown;
mod snapshots;
mod spectrogram;
mod submit;
mod trust;
mod units;
mod upkeep;
mod verification;
