//! Feedback of the motion of the bit on weight and torque on bit, linearised about steady drilling.

use std::f64::consts::TAU;

use drillsweep_scenario::{Bit, SteadyCut};
use nalgebra::Complex;

/// Loads on the bit by its motion: 1 + P(s) H_a + Q(s) H_t is the characteristic function with the axial and torsional receptance of the string.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Feedback {
    /// A bit that cuts what the blade before left: P = K (1 - exp(-s tau)), Q = -K c (1 - exp(-s tau)).
    Regenerative {
        /// K = n a zeta eps \[N/m\].
        stiffness: f64,
        /// c = (V0 / Omega) a / (2 zeta) \[m2\]: of torque by weight, and depth of cut by twist.
        coupling: f64,
        /// tau = 2 pi / (n Omega) \[s\].
        delay: f64,
    },
    /// Torque on bit that falls with the speed of the bit: Q = -b s.
    Weakening {
        /// b, fall of the torque by speed \[N m s\].
        slope: f64,
    },
}

impl Feedback {
    /// The regenerative law of a bit of a radius \[m\] at a speed \[rad/s\].
    pub(super) fn regenerative(bit: &Bit, radius: f64, cut: SteadyCut, speed: f64) -> Self {
        Self::Regenerative {
            stiffness: f64::from(bit.blades) * radius * bit.inclination * bit.specific_energy,
            coupling: cut.depth_of_cut / TAU * radius / (2.0 * bit.inclination),
            delay: TAU / (f64::from(bit.blades) * speed),
        }
    }

    /// P(s) \[N/m\] and Q(s) \[N m\].
    pub(super) fn at(&self, s: Complex<f64>) -> [Complex<f64>; 2] {
        match *self {
            Self::Regenerative { delay, .. } => self.with_return(s, (s * -delay).exp()),
            Self::Weakening { .. } => self.with_return(s, Complex::new(0.0, 0.0)),
        }
    }

    /// P and Q with exp(-s tau).
    fn with_return(&self, s: Complex<f64>, returned: Complex<f64>) -> [Complex<f64>; 2] {
        match *self {
            Self::Regenerative { stiffness, coupling, .. } => {
                let regained = (-returned + 1.0) * stiffness;
                [regained, regained * -coupling]
            }
            Self::Weakening { slope } => [Complex::new(0.0, 0.0), s * -slope],
        }
    }

    /// P and Q at places from `start` in equal steps.
    pub(super) fn along(&self, start: Complex<f64>, step: Complex<f64>) -> Along<'_> {
        let delay = self.delay();
        Along { feedback: self, returned: (start * -delay).exp(), turn: (step * -delay).exp() }
    }

    /// Time of its delay \[s\]; 0 without one.
    pub(super) fn delay(&self) -> f64 {
        match *self {
            Self::Regenerative { delay, .. } => delay,
            Self::Weakening { .. } => 0.0,
        }
    }

    /// Bound of |P H_a + Q H_t| at a frequency \[rad/s\] and at all motions that do not decay there, by bounds of the receptances.
    pub(super) fn bound(&self, omega: f64, [axial, torsional]: [f64; 2]) -> f64 {
        match *self {
            Self::Regenerative { stiffness, coupling, .. } => {
                2.0 * stiffness * (axial + coupling * torsional)
            }
            Self::Weakening { slope } => slope.abs() * omega * torsional,
        }
    }
}

/// P and Q at places one after the other, exp(-s tau) by the turn from each to the next.
pub(super) struct Along<'a> {
    feedback: &'a Feedback,
    returned: Complex<f64>,
    turn: Complex<f64>,
}

impl Along<'_> {
    /// P and Q at the next place, which is s.
    pub(super) fn next_at(&mut self, s: Complex<f64>) -> [Complex<f64>; 2] {
        let shares = self.feedback.with_return(s, self.returned);
        self.returned *= self.turn;
        shares
    }
}
