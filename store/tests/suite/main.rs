//! What the store promises, on real files: who gets what to do, what is kept, what a late writer cannot do. Time
//! passes by opening the same file with a later clock.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod bench;
mod blobs;
mod cancel;
mod check;
mod concurrency;
mod control;
mod counts;
mod failure;
mod fairness;
mod lease;
mod probe;
mod retention;
mod submit;
mod table;
mod token;
