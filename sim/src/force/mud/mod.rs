//! The mud: the effect of its flow on the string (docs/model/mud.md).
//!
//! The chain of one element runs from the flow rate to the fluid's coefficients: laminar wall stress
//! (`slot` and `pipe`), regime limits, friction factor, eccentricity and rotation factors, apparent
//! viscosity, damping. [`SectionFlow`] holds the quantities of a cross-section, [`ElementFlow`] adds the position
//! of the pipe in the hole, [`Pressures`] adds the elements up along the string.
//!
//! The mud is a yield-power-law (Herschel-Bulkley) fluid, tau = tau_y + K gamma^n. It flows down the bore
//! at U_i and up the annulus at U_o, both counted positive.

mod damping;
mod eccentricity;
mod element;
mod error;
mod friction_factor;
mod geometry;
mod laminar;
mod momentum;
mod pipe;
mod pressure;
mod regime;
mod rheology;
mod rotation;
mod slot;

pub use element::{ElementFlow, SectionFlow, element_flow};
pub use error::MudError;
pub use geometry::FlowGeometry;
pub use momentum::FlowMomentum;
pub use pressure::{PressureStep, Pressures, pressures};
pub use regime::Regime;
