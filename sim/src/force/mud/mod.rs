//! The mud: the effect of its flow on the string (docs/model/mud.md).
//!
//! The chain of one element runs from the flow rate to the fluid's coefficients: laminar wall stress
//! (`slot` and `pipe`), regime limits, friction factor, eccentricity and rotation factors, apparent
//! viscosity, damping. [`SectionFlow`] holds the quantities of a cross-section, [`ElementFlow`] adds the position
//! of the pipe in the hole, [`Pressures`] adds the elements up along the string.
//! Reported pressures may follow other formulas ([`SectionLosses`], [`Rp13dFlow`]), and contain nozzles and surface lines ([`CircuitLosses`]).
//!
//! The mud is a yield-power-law (Herschel-Bulkley) fluid, tau = tau_y + K gamma^n. It flows down the bore
//! at U_i and up the annulus at U_o, both counted positive.

mod circuit;
mod damping;
mod eccentricity;
mod element;
mod error;
mod friction_factor;
mod geometry;
mod laminar;
mod losses;
mod momentum;
mod pipe;
mod pressure;
mod regime;
mod rheology;
mod rotation;
mod rp13d;
mod slot;

pub use circuit::{CircuitLosses, SURFACE_CASES};
pub use element::{ElementFlow, SectionFlow, element_flow};
pub use error::MudError;
pub use geometry::FlowGeometry;
pub use losses::{FrictionGradients, SectionLosses};
pub use momentum::FlowMomentum;
pub use pressure::{PressureStep, Pressures, pressures};
pub use regime::Regime;
pub use rp13d::Rp13dFlow;
