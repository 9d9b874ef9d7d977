//! Response of small motions about the equilibrium to a harmonic load.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::pencil::Pencil;
use super::shifted::ShiftedPencil;
use crate::force::unbalance;
#[cfg(test)]
use crate::math::dof::W;
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
        Self::at(pencil, Complex::new(0.0, TAU * frequency_hz))
    }

    /// Receptance of motions exp(s t).
    pub(crate) fn at(pencil: &'a Pencil, shift: Complex<f64>) -> Option<Self> {
        let factor = ShiftedPencil::new(shift, pencil.matrices(), &pencil.held)?;
        Some(Self { factor, held: &pencil.held })
    }

    /// Response to the mass unbalance \[m, rad\] of the pencil's model, if the frequency is that of the rotation.
    pub fn to_unbalance(&self, model: &Model) -> Response {
        let mut load = self.no_load();
        for force in unbalance::forces(&model.mesh.nodes, &model.drive) {
            add_turning(&mut load[force.node], force.amplitude, force.phase);
        }
        self.to(load)
    }

    /// Response to a lateral force at a node, of an amplitude \[N\], that turns clockwise with the frequency.
    pub(super) fn to_turning_force(&self, node: usize, amplitude: f64) -> Response {
        let mut load = self.no_load();
        add_turning(&mut load[node], amplitude, 0.0);
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

    /// Displacement and twist of the bit by an axial force of 1 N on it, and by a torque of 1 N m \[m, rad\].
    #[cfg(test)]
    pub(crate) fn of_bit(&self) -> [[Complex<f64>; 2]; 2] {
        [W, THETA_Z].map(|dof| {
            let mut load = self.no_load();
            let bit = load.len() - 1;
            load[bit][dof] = Complex::new(1.0, 0.0);
            let response = self.to(load)[bit];
            [response[W], response[THETA_Z]]
        })
    }

    /// Amplitude \[m/N, rad/(N m)\] of a degree of freedom of a node by a force along it.
    #[cfg(test)]
    pub(crate) fn of_node(&self, (node, dof): (usize, usize)) -> Complex<f64> {
        let mut load = self.no_load();
        load[node][dof] = Complex::new(1.0, 0.0);
        self.to(load)[node][dof]
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

/// Adds A cos(w t + phase) along u and A sin(w t + phase) along v.
fn add_turning(load: &mut [Complex<f64>; DOFS], amplitude: f64, phase: f64) {
    let (sine, cosine) = phase.sin_cos();
    let along_u = Complex::new(cosine, sine) * amplitude;
    load[U] += along_u;
    load[V] += along_u * Complex::new(0.0, -1.0);
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{TopCondition, preset};
    use serde_json::{Value, json};

    use super::*;
    use crate::solve::modes::{ModeKind, ModeSearch, modes};
    use crate::solve::statics::Equilibrium;

    #[test]
    fn torsional_modes_of_the_published_string_lose_their_energy_through_a_top_that_continues() {
        let vertical: Vec<Value> = [0.0, 200.0]
            .map(|depth| json!({ "measured_depth": depth, "inclination_deg": 0.0, "azimuth_deg": 0.0 }))
            .into();
        let changes = [
            ("well.survey", json!(vertical)),
            ("mud", Value::Null),
            ("string.unbalance", json!([])),
            ("operation.weight_on_bit", json!(0.0)),
            ("operation.torque_on_bit", json!(0.0)),
            ("damping.mass_proportional", json!(0.0)),
            ("damping.stiffness_proportional", json!(0.0)),
            ("effects", json!({ "contact": "off", "torsion": "on", "axial_motion": "off" })),
        ];
        let base = preset("paper-200m").unwrap();
        let scenario =
            changes.into_iter().fold(base, |scenario, (path, value)| scenario.with(path, value).unwrap());
        // Transfer matrices of the stepped shaft: held, and with Z_t = I_p sqrt(rho G) at its top. Modes without oscillation that decay are not listed.
        for (top, wanted) in [
            (TopCondition::Clamped, vec![(0.0, 2.160), (0.0, 12.853)]),
            (TopCondition::Continues, vec![(-5.891, 14.372)]),
        ] {
            let mut scenario = scenario.clone();
            scenario.operation.top = top;
            let model = Model::new(&scenario).unwrap();
            let equilibrium = Equilibrium::find(&model).unwrap();
            let search = ModeSearch { to_hz: 16.0, ..ModeSearch::default() };
            let found = modes(&model, &equilibrium, &search).unwrap();
            let twist = found.modes.iter().filter(|mode| mode.kind == ModeKind::Torsional);
            let twist: Vec<_> = twist.map(|mode| (mode.growth_rate, mode.frequency_hz)).collect();
            assert_eq!(twist.len(), wanted.len(), "{top:?}: {twist:?}");
            for ((growth, frequency), (wanted_growth, wanted_frequency)) in twist.iter().zip(wanted) {
                // Rounding of the figures; elements of at most 1.6 m are off by (omega l / c)^2 / 24 < 1e-4.
                assert!((growth - wanted_growth).abs() < 2e-3, "{top:?}: {twist:?}");
                assert!((frequency - wanted_frequency).abs() < 2e-3, "{top:?}: {twist:?}");
            }
        }
        // The twist of the bit by a torque that grows as exp(s t) has a pole at s = -5.527 1/s.
        let mut scenario = scenario;
        scenario.operation.top = TopCondition::Continues;
        let model = Model::new(&scenario).unwrap();
        let pencil = Pencil::about(&model, &Equilibrium::find(&model).unwrap());
        let twist = |growth: f64| {
            let factor =
                ShiftedPencil::new(Complex::new(growth, 0.0), pencil.matrices(), &pencil.held).unwrap();
            let receptance = Receptance { factor, held: &pencil.held };
            let mut load = receptance.no_load();
            load[model.node_count() - 1][THETA_Z] = Complex::new(1.0, 0.0);
            receptance.to(load)[model.node_count() - 1][THETA_Z].re
        };
        let [below, above] = [-5.529, -5.525].map(twist);
        assert!(
            below * above < 0.0 && below.abs().min(above.abs()) > 10.0 * twist(-4.5).abs(),
            "{below} {above}"
        );
    }
}
