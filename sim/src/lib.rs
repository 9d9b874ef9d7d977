//! The dynamics of a drillstring in a 3D well, with mud, borehole contact and friction.
//!
//! The crate reads as one sentence: a [scenario](drillsweep_scenario) becomes a `model` (mesh and matrices of the effects in
//! play), the model has an equilibrium (`statics`), the equilibrium a hydraulic profile ([`mud`]), and from
//! there a `transient` yields records, from which orbits and full spectra are cut ([`signal`]).
//!
//! ```
//! use drillsweep_sim::model::Model;
//! use drillsweep_sim::modes::{ModeSearch, modes};
//! use drillsweep_sim::statics::Equilibrium;
//!
//! let scenario = drillsweep_scenario::preset("paper-200m").unwrap();
//! let model = Model::new(&scenario)?;
//! let equilibrium = Equilibrium::find(&model)?;
//! // Tension at the bit is the weight on bit.
//! assert!((equilibrium.tension.last().unwrap() - scenario.operation.weight_on_bit).abs() < 100.0);
//! // Friction at the wall feeds the lowest torsional mode: stick-slip.
//! let found = modes(&model, &equilibrium, &ModeSearch { to_hz: 2.5, ..ModeSearch::default() })?;
//! let growing = found.modes.iter().find(|mode| mode.growth_rate > 0.0).unwrap();
//! assert!((growing.frequency_hz - 2.16).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! SI units throughout. Nothing here knows of files, clocks, threads, SQL or HTTP: the same scenario gives
//! the same bits wherever it runs.

pub mod admission;
pub mod beam;
pub mod canonical;
pub mod contact;
pub mod control;
pub mod drive;
pub mod effect;
mod force;
pub mod freedom;
pub mod linalg;
pub mod model;
pub mod modes;
pub mod motion;
pub mod mud;
pub mod signal;
pub mod statics;
pub mod string;
pub mod study;
mod term;
pub mod transient;
pub mod well;

/// Version of the numbers: raised by hand whenever the same scenario may give other results, and part of every
/// result's key.
pub const PHYSICS_VERSION: u32 = 11;
