//! Response of small motions about the equilibrium to a harmonic load.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::pencil::Pencil;
use super::shifted::ShiftedPencil;
use crate::force::unbalance;
use crate::math::dof::{DOFS, THETA_Z, U, V};
use crate::solve::model::Model;

/// Amplitudes of all degrees of freedom, node by node from the top: the motion is their real part times exp(i w t).
pub type Response = Vec<[Complex<f64>; DOFS]>;

/// The equations of small motions at one frequency, factored: (K + i w C - w^2 M) x = f.
pub struct Receptance<'a> {
    factor: ShiftedPencil,
    held: &'a [[bool; DOFS]],
}

impl<'a> Receptance<'a> {
    /// Receptance of small motions at a frequency \[Hz\]; `None` at an undamped resonance.
    pub fn of(pencil: &'a Pencil, frequency_hz: f64) -> Option<Self> {
        let shift = Complex::new(0.0, TAU * frequency_hz);
        let factor = ShiftedPencil::new(shift, pencil.matrices(), &pencil.held)?;
        Some(Self { factor, held: &pencil.held })
    }

    /// Response to the mass unbalance \[m, rad\] of the pencil's model, if the frequency is that of the rotation.
    pub fn to_unbalance(&self, model: &Model) -> Response {
        let mut load = self.no_load();
        for force in unbalance::forces(&model.mesh.nodes, &model.drive) {
            let (sine, cosine) = force.phase.sin_cos();
            // A cos(w t + phase) along u, A sin(w t + phase) along v.
            let along_u = Complex::new(cosine, sine) * force.amplitude;
            load[force.node][U] += along_u;
            load[force.node][V] += along_u * Complex::new(0.0, -1.0);
        }
        self.to(load)
    }

    /// Response to a torque at the bit that twists it by one radian.
    pub fn to_twist_of_bit(&self) -> Response {
        let mut load = self.no_load();
        if let Some(bit) = load.last_mut() {
            bit[THETA_Z] = Complex::new(1.0, 0.0);
        }
        let mut response = self.to(load);
        let twist = response.last().map_or(Complex::new(0.0, 0.0), |bit| bit[THETA_Z]);
        if twist.norm_sqr() > 0.0 {
            response.as_flattened_mut().iter_mut().for_each(|value| *value /= twist);
        }
        response
    }

    fn no_load(&self) -> Response {
        vec![[Complex::new(0.0, 0.0); DOFS]; self.held.len()]
    }

    fn to(&self, mut load: Response) -> Response {
        for (load, held) in load.iter_mut().zip(self.held) {
            for (value, _) in load.iter_mut().zip(held).filter(|(_, held)| **held) {
                *value = Complex::new(0.0, 0.0);
            }
        }
        self.factor.solve_in_place(load.as_flattened_mut());
        load
    }
}
