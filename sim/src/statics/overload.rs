//! Loads beyond the string's stability: why there may be no equilibrium.

use std::f64::consts::PI;
use std::fmt;

use crate::model::Model;

/// Stretch of string that is loaded beyond its stability while nothing holds it in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overload {
    /// Measured depth of its upper end \[m\].
    pub measured_depth: f64,
    /// Its length \[m\]: an element, since the wall holds nodes only; the whole string where there is no wall.
    pub length: f64,
    /// Compression \[N\], with the flow's momentum.
    pub compression: f64,
    /// Torque \[N m\].
    pub torque: f64,
    /// `P / P_Euler + (T / T_Greenhill)^2`, pinned ends; 1 is the limit.
    pub ratio: f64,
}

impl fmt::Display for Overload {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "the string is physically unstable: {:.2} m at {:.1} m depth carry {:.1} kN of compression and {:.2} kN m of torque, {:.3} times \
             what buckles them between their ends",
            self.length,
            self.measured_depth,
            self.compression / 1e3,
            self.torque / 1e3,
            self.ratio
        )
    }
}

/// What a failed search says about the physics.
pub(super) fn verdict(overload: Option<&Overload>) -> String {
    overload.map_or_else(
        || "no stretch of the string is beyond its buckling load: the search itself failed".to_owned(),
        Overload::to_string,
    )
}

/// The stretch that is furthest beyond its stability under `load`, if there is any.
///
/// A shaft with pinned ends under thrust P and torque T buckles where P / (EI) + (T / 2EI)^2 = (pi / l)^2 (Greenhill 1883). Tension is
/// summed up from the bit along the string's buoyed weight, without the wall's friction and the mud's drag; torque is the bit's.
pub(super) fn find(model: &Model) -> Option<Overload> {
    let string = model.mesh.length();
    let torque = if model.effects.torque_stiffening { model.scenario.operation.torque_on_bit } else { 0.0 };
    let mut tension = model.scenario.operation.weight_on_bit;
    let mut worst: Option<Overload> = None;
    for (e, element) in model.elements.iter().enumerate().rev() {
        tension += 0.5 * element.axial_weight;
        let bending = element.beam.section().bending_stiffness();
        let momentum =
            element.momentum.filter(|_| model.effects.flow_stiffness).map_or(0.0, |flow| flow.lateral_flux());
        let middle = tension;
        tension += 0.5 * element.axial_weight;
        let thrust = if model.effects.axial_stiffening { -middle } else { 0.0 };
        let compression = thrust + momentum;
        let length = if model.effects.contact { element.beam.length() } else { string };
        let ratio = (compression / bending + (0.5 * torque / bending).powi(2)) * (length / PI).powi(2);
        if ratio > worst.map_or(1.0, |worst| worst.ratio) {
            let measured_depth = if model.effects.contact { model.mesh.elements[e].top } else { 0.0 };
            worst = Some(Overload { measured_depth, length, compression, torque, ratio });
        }
    }
    worst
}
