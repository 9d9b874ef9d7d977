//! The dynamics of a drillstring in a 3D well, with mud, borehole contact and friction.
//!
//! A [scenario](drillsweep_scenario) becomes a [`Model`](solve::model::Model): mesh, and matrices of its active effects. The model has an
//! [`Equilibrium`](solve::statics::Equilibrium) with a hydraulic profile ([`force::mud`]); from there a
//! [`Transient`](solve::run::Transient) yields records, from which orbits and full spectra are computed ([`math::signal`]). The crate has five
//! storeys, each above those that it uses: [`math`], [`string`], [`force`], [`solve`], [`validation`].
//!
//! ```
//! use drillsweep_sim::solve::model::Model;
//! use drillsweep_sim::solve::modes::{ModeSearch, modes};
//! use drillsweep_sim::solve::statics::Equilibrium;
//!
//! let scenario = drillsweep_scenario::preset("paper-200m").unwrap();
//! let model = Model::new(&scenario)?;
//! let equilibrium = Equilibrium::find(&model)?;
//! // Tension at the bit is the weight on bit.
//! assert!((equilibrium.tension.last().unwrap() - scenario.operation.weight_on_bit).abs() < 100.0);
//! // Friction at the wall excites the lowest torsional mode: stick-slip.
//! let found = modes(&model, &equilibrium, &ModeSearch { to_hz: 2.5, ..ModeSearch::default() })?;
//! let growing = found.modes.iter().find(|mode| mode.growth_rate > 0.0).unwrap();
//! assert!((growing.frequency_hz - 2.16).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! SI units throughout. The crate uses no files, clocks, threads, SQL or HTTP: the same scenario gives the same bits on every machine.

pub mod control;
pub mod force;
pub mod key;
pub mod math;
pub mod solve;
pub mod string;
pub mod validation;

/// Version of the numbers: raised by hand whenever the same scenario may give other results, and part of every
/// result's key.
pub const PHYSICS_VERSION: u32 = 15;
