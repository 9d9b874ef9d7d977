//! Integration of tension and torque along a string in its hole.

use super::error::SoftStringError;
use super::string::{Part, SoftString};
use crate::force::contact::BodyMotion;

/// Largest turn of the hole in one step \[rad\]: RK4 then leaves less than 1e-11 of the tension a step, whatever the friction.
const LARGEST_TURN: f64 = 0.02;

/// Excess \[m\] of a bit depth over the string's length that is rounding.
const DEPTH_ROUNDING: f64 = 1e-6;

/// Distance below which two depths are one \[m\].
const SAME_DEPTH: f64 = 1e-9;

impl SoftString {
    /// The string with its bit at a depth \[m\], shortened at its top.
    pub(super) fn laid(&self, bit_depth: f64) -> Result<LaidString<'_>, SoftStringError> {
        if bit_depth > 0.0 && bit_depth <= self.deepest() + DEPTH_ROUNDING {
            Ok(LaidString::new(self, bit_depth))
        } else {
            Err(SoftStringError::BitDepth { bit_depth, deepest: self.deepest() })
        }
    }
}

/// A string with its bit at one depth, cut into steps on which weight, friction and curvature are constant.
pub(super) struct LaidString<'a> {
    /// Steps from the bit upwards.
    pub(super) steps: Vec<Step<'a>>,
}

/// A piece of a string, for one step of the integration.
pub(super) struct Step<'a> {
    pub(super) part: &'a Part,
    /// Measured depths of the upper and the lower end \[m\].
    pub(super) depths: [f64; 2],
    /// Index of the hole.
    hole: usize,
    /// Diameter of the hole \[m\].
    pub(super) hole_diameter: f64,
    /// Curvature \[1/m\].
    pub(super) curvature: f64,
    /// Weight along the string, towards the centre of curvature and across both \[N/m\], at the lower end, the middle and the upper end.
    weight: [[f64; 3]; 3],
}

/// Forces at the upper and the lower end of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends {
    pub(super) tension: [f64; 2],
    pub(super) torque: [f64; 2],
    pub(super) side_force: [f64; 2],
}

/// Forces at the top of a string.
#[derive(Debug, Clone, Copy)]
pub(super) struct TopForces {
    /// Effective tension \[N\].
    pub(super) tension: f64,
    /// Torque \[N m\].
    pub(super) torque: f64,
    /// Side force of the whole string \[N\].
    pub(super) side_force: f64,
}

impl<'a> LaidString<'a> {
    pub(super) fn new(string: &'a SoftString, bit_depth: f64) -> Self {
        let raised = string.length - bit_depth;
        let part_tops = string.parts.iter().map(|part| part.ends[0] - raised);
        let inner = part_tops.chain(string.path.stations()).chain(string.section_tops.iter().copied());
        let mut depths: Vec<f64> =
            inner.filter(|depth| (SAME_DEPTH..bit_depth - SAME_DEPTH).contains(depth)).collect();
        depths.extend([0.0, bit_depth]);
        depths.sort_by(f64::total_cmp);
        depths.dedup_by(|lower, upper| *lower - *upper < SAME_DEPTH);
        let mut steps = Vec::with_capacity(2 * depths.len());
        for pair in depths.windows(2).rev() {
            let (length, middle) = (pair[1] - pair[0], 0.5 * (pair[0] + pair[1]));
            let below = string.parts.partition_point(|part| part.ends[0] - raised <= middle);
            let part = &string.parts[below.saturating_sub(1)];
            let hole = string.section_tops.partition_point(|top| *top <= middle);
            let curvature = string.path.on_arc(middle, middle).1.norm();
            let count = (curvature * length / LARGEST_TURN).ceil().max(1.0);
            let depth = |i: f64| pair[1] - length * i / count;
            for i in (0..count as u32).map(f64::from) {
                let depths = [depth(i + 1.0), depth(i)];
                let weight = [depths[1], 0.5 * (depths[0] + depths[1]), depths[0]].map(|depth| {
                    let (tangent, inward) = string.path.on_arc(middle, depth);
                    let across = (1.0 - tangent.z * tangent.z).max(0.0);
                    let inward = if curvature > 0.0 { inward.z / curvature } else { across.sqrt() };
                    let binormal = (across - inward * inward).max(0.0).sqrt();
                    [tangent.z, inward, binormal].map(|direction| part.weight * direction)
                });
                let hole_diameter = string.holes[hole].diameter;
                steps.push(Step { part, depths, hole, hole_diameter, curvature, weight });
            }
        }
        Self { steps }
    }

    /// Forces at the top, from the tension \[N\] and torque \[N m\] at the bit; `visit` receives every step on the way up.
    ///
    /// RK4 along the arcs. A side force that passes through zero, where tension turns the string over to the other side of the hole, leaves a
    /// kink, and an error of the third order in its one step.
    pub(super) fn forces(
        &self,
        friction: &[f64],
        motion: &BodyMotion,
        [mut tension, mut torque]: [f64; 2],
        mut visit: impl FnMut(&Step<'a>, &Ends),
    ) -> TopForces {
        let mut total = 0.0;
        for step in &self.steps {
            // Friction along the string, uphole positive, pulls on the pipe above.
            let [about, along] = motion.direction(step.part.contact_radius);
            let along = -along;
            let (friction, length) = (friction[step.hole], step.depths[1] - step.depths[0]);
            let drag = friction * along;
            // Rise of the tension, and side force.
            let slope = |tension: f64, place: usize| {
                let side_force = step.side_force(tension, place);
                (step.weight[place][0] + drag * side_force, side_force)
            };
            let (k1, n1) = slope(tension, 0);
            let (k2, n2) = slope(tension + 0.5 * length * k1, 1);
            let (k3, n3) = slope(tension + 0.5 * length * k2, 1);
            let (k4, n4) = slope(tension + length * k3, 2);
            let sum = length / 6.0 * (n1 + 2.0 * (n2 + n3) + n4);
            let (lower_tension, lower_torque) = (tension, torque);
            tension += length / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
            torque += friction * about * step.part.contact_radius * sum;
            total += sum;
            visit(
                step,
                &Ends {
                    tension: [tension, lower_tension],
                    torque: [torque, lower_torque],
                    side_force: [step.side_force(tension, 2), n1],
                },
            );
        }
        TopForces { tension, torque, side_force: total }
    }
}

impl Step<'_> {
    /// Side force \[N/m\] at the lower end (0), the middle (1) or the upper end (2).
    fn side_force(&self, tension: f64, place: usize) -> f64 {
        let [_, inward, binormal] = self.weight[place];
        let pull = tension * self.curvature + inward;
        (pull * pull + binormal * binormal).sqrt()
    }
}
