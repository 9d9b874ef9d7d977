//! Orbits and full spectra of recorded lateral motion, and the settling of that motion.
//!
//! A node's motion is the complex signal z = u + i v. Turning in the sense of the string's rotation (from u to
//! v) is forward whirl, at positive frequencies; turning against it is backward whirl.

mod course;
mod fft;
mod orbit;
mod spectrum;
mod window;

#[cfg(test)]
mod tests;

pub use course::{Agreement, Allowed, Batches, Course, LONGEST_WINDOW, halves};
pub use orbit::{OrbitStatistics, orbit_statistics, weighted_orbit_statistics};
pub use spectrum::{FullSpectrum, Peak, PeakSearch, Whirl, full_spectrum};
pub use window::{Window, sample_range};
