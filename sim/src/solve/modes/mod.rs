//! Small motions about the equilibrium: frequencies, growth, direction.
//!
//! The equations of motion are linearised about the equilibrium with its contacts closed and sliding at the speed of rotation
//! ([`Pencil`]): normal stiffness and damping of the wall, friction's direction and the slope of its curve, mud damping,
//! Coriolis and flow stiffness, gyroscopic terms. A mode that grows here grows in a run until contact or sliding limits it. Eigenvalues
//! are found around shifts that walk along the imaginary axis, and counted by the winding number of the determinant around the band: the
//! list is complete if its length is the count.

mod accuracy;
mod arnoldi;
mod component;
mod count;
mod forced;
mod mode;
mod pencil;
mod receptance;
mod shape;
mod shifted;
mod stability;
mod torsion;
mod walk;

pub use component::component_names;
pub use forced::{
    ComponentResponse, ElementResponse, Excitation, ForcedError, MOST_SPEEDS, NodeResponse, SpeedResponse,
    component_responses, forced_response,
};
pub use mode::{BIT_NOT_JUDGED, Completeness, Mode, ModeKind, ModeSearch, Modes, ModesError};
pub use pencil::Pencil;
pub use receptance::{Receptance, Response};
pub use shape::{MOST_SHAPES, ModeShape, ShapeNode, mode_shapes};
pub use stability::{Instability, InstabilityKind, Stability, stability, static_stability};
pub(in crate::solve) use torsion::rubbing;
pub use torsion::{TorsionalMode, UndampedTorsion, growing_torsion, torsional_modes};

use std::f64::consts::TAU;

use crate::solve::model::Model;
use crate::solve::statics::Equilibrium;
use walk::{eigenpairs, uncounted_eigenpairs};

/// The modes of a model about its equilibrium.
///
/// # Errors
/// The band is empty, its eigenvalues cannot be found, or the string has an axial speed or a top drive with Z-torque.
pub fn modes(model: &Model, equilibrium: &Equilibrium, search: &ModeSearch) -> Result<Modes, ModesError> {
    ModesError::require_modes(model)?;
    modes_of(&Pencil::about(model, equilibrium), &model.mesh.depths(), search)
}

/// The modes of a model about its equilibrium in bands of frequencies \[Hz\] that do not overlap. A whole well has some thousand modes up to 20 Hz,
/// and counting those of a band takes longer than finding them, so that they are not counted. A top drive with Z-torque counts as a stiff one.
///
/// # Errors
/// As [`modes`] but for Z-torque.
pub fn modes_in(
    model: &Model,
    equilibrium: &Equilibrium,
    bands: &[[f64; 2]],
) -> Result<Vec<Mode>, ModesError> {
    ModesError::require_no_axial_speed(model.body_motion())?;
    let (pencil, depths) = (Pencil::about(model, equilibrium), model.mesh.depths());
    let mut found = Vec::new();
    for &[from_hz, to_hz] in bands {
        let search = ModeSearch { from_hz, to_hz, ..ModeSearch::default() };
        let pairs = uncounted_eigenpairs(&pencil, &search)?;
        found.extend(pairs.in_band(&search).map(|pair| Mode::new(&pencil, pair, &depths)));
    }
    Ok(found)
}

/// The modes of a pencil whose nodes are at `depths` \[m\].
///
/// # Errors
/// As [`modes`].
pub fn modes_of(pencil: &Pencil, depths: &[f64], search: &ModeSearch) -> Result<Modes, ModesError> {
    let found = eigenpairs(pencil, search)?;
    Ok(Modes {
        modes: found.in_band(search).map(|pair| Mode::new(pencil, pair, depths)).collect(),
        complete_to_hz: (found.complete_to / TAU).min(search.to_hz),
        complete_to_rate: found.rate,
        completeness: found.completeness,
    })
}
