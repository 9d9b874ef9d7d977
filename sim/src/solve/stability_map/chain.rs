//! Waves along the string: rods in tension and shafts in torsion, chained from the top to the bit.
//!
//! A uniform part of travel time t and impedance Z obeys (s + alpha) s w = (1 + beta s) c^2 w'': with g^2 = s (s + alpha) / (1 + beta s) motion w and force N at its lower end are
//! w cosh(g t) + N sinh(g t) / (Z z) and N cosh(g t) + Z z w sinh(g t), z = (1 + beta s) g. Both are analytic in s, so that neither has poles: those of the receptance w / N
//! are the zeros of N. A factor exp(-g t) for each part keeps them within the range of numbers.

use std::f64::consts::FRAC_PI_4;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::force::top_drive::SpeedControl;

/// Axial condition of the top in a stability map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AxialTop {
    /// The top descends at the rate of penetration.
    #[default]
    Advance,
    /// The top moves freely under a constant hook load.
    HookLoad,
}

/// A uniform part with a damper at its lower end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    /// Time of a wave through it \[s\].
    pub(super) travel_time: f64,
    /// Force by the speed of a wave \[N s/m, N m s\].
    pub(super) impedance: f64,
    /// Force of the damper by speed \[N s/m, N m s\]; negative if it excites.
    pub(super) damper: f64,
}

/// Filter of the torque that Z-torque follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TorqueFilter {
    /// Change of the set speed by torque f / Z \[rad/(N m s)\].
    pub(super) per_torque: f64,
    /// tau \[s\].
    pub(super) time_constant: f64,
}

/// Condition at the upper end of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Top {
    /// It does not move.
    Held,
    /// No force acts on it.
    Free,
    /// A pipe goes on upwards, of an impedance \[N s/m, N m s\], to a held end from which waves return after a time \[s\]; absent without such an end.
    Continues { impedance: f64, return_time: Option<f64> },
    /// A drive with inertia turns it.
    Driven { control: SpeedControl, filter: Option<TorqueFilter> },
}

/// Parts from the top to the bit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    top: Top,
    parts: Vec<Part>,
    /// alpha \[1/s\] and beta \[s\] of Rayleigh damping.
    rayleigh: [f64; 2],
}

/// Lower end of a chain that moves as exp(s t), but for a common factor: displacement over `force` is the receptance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct End {
    /// Displacement \[m, rad\].
    pub(super) displacement: Complex<f64>,
    /// Force \[N, N m\], over s of a free chain, whose rigid motion makes it zero with s.
    pub(super) force: Complex<f64>,
}

impl Chain {
    /// A chain of parts from the top; neighbours of one impedance without a damper between them are one part.
    pub(super) fn new(top: Top, parts: impl IntoIterator<Item = Part>, rayleigh: [f64; 2]) -> Self {
        let mut joined: Vec<Part> = Vec::new();
        for part in parts {
            match joined.last_mut() {
                Some(above) if above.damper == 0.0 && above.impedance == part.impedance => {
                    above.travel_time += part.travel_time;
                    above.damper = part.damper;
                }
                _ => joined.push(part),
            }
        }
        Self { top, parts: joined, rayleigh }
    }

    /// True if the chain moves as a rigid body.
    pub(super) fn is_free(&self) -> bool {
        self.top == Top::Free
    }

    /// Time of a wave from the top to the bit \[s\].
    pub(super) fn travel_time(&self) -> f64 {
        self.parts.iter().map(|part| part.travel_time).sum()
    }

    /// Number of uniform parts.
    pub(super) fn len(&self) -> usize {
        self.parts.len()
    }

    /// Lower end, times exp(-g t) of every part.
    pub(super) fn end(&self, s: Complex<f64>) -> End {
        let [alpha, beta] = self.rayleigh;
        let lossy = s * beta + 1.0;
        let g = (s * (s + alpha)).sqrt() / lossy.sqrt();
        let z = lossy * g;
        let [mut displacement, mut force] = self.top_state(s);
        for part in &self.parts {
            let returned = (g * (-2.0 * part.travel_time)).exp();
            let (cosh, sinh) = ((returned + 1.0) * 0.5, (-returned + 1.0) * 0.5);
            let impedance = z * part.impedance;
            let upper = displacement;
            displacement = upper * cosh + force * sinh / impedance;
            force = force * cosh + upper * sinh * impedance + s * displacement * part.damper;
        }
        End { displacement, force: if self.is_free() { force / s } else { force } }
    }

    /// Exponent by which the factor exp(-g t) of the end becomes exp(s t - s t / sqrt(1 + beta s)), which is analytic next to the imaginary axis.
    pub(super) fn excess(&self, s: Complex<f64>) -> Complex<f64> {
        let [alpha, beta] = self.rayleigh;
        let lossy = s * beta + 1.0;
        let root = lossy.sqrt();
        ((s * (s + alpha)).sqrt() / root - s / root + s) * self.travel_time()
    }

    /// Displacement and force at the top, but for a common factor.
    fn top_state(&self, s: Complex<f64>) -> [Complex<f64>; 2] {
        let one = Complex::new(1.0, 0.0);
        match self.top {
            Top::Held => [Complex::new(0.0, 0.0), one],
            Top::Free => [one, Complex::new(0.0, 0.0)],
            Top::Continues { impedance, return_time: None } => [one, s * impedance],
            Top::Continues { impedance, return_time: Some(time) } => {
                let returned = (s * -time).exp();
                [one - returned, s * impedance * (one + returned)]
            }
            Top::Driven { control: SpeedControl { inertia, damping, stiffness }, filter } => {
                let control = s * damping + stiffness;
                let followed = filter.map_or(Complex::new(0.0, 0.0), |filter| {
                    control * filter.per_torque * filter.time_constant / (s * filter.time_constant + 1.0)
                });
                [one + followed, s * s * inertia + control]
            }
        }
    }

    /// Bound of the receptance \[m/N, rad/(N m)\] at all frequencies from `omega` \[rad/s\] on; infinite if waves return from the top too little damped, or if
    /// the top is not known to be passive.
    ///
    /// The part R of a wave at the bit that returns: at most 1 from a held or free top, (1 + sin p) / cos p from a passive one with the phase p of z / s, at most
    /// pi/4. A part takes exp(-2 Re(g) t) of it, a step of impedances maps it by (r + R) / (1 + r R), a damper by (2 R - q (1 + R)) / (2 + q (1 + R)); the
    /// receptance is (1 + R) / ((1 - R) Z z).
    pub(super) fn bound(&self, omega: f64) -> f64 {
        let [alpha, beta] = self.rayleigh;
        let s = Complex::new(0.0, omega);
        let rate = (s * (s + alpha) / (s * beta + 1.0)).sqrt().re;
        let mut returned = match self.top {
            Top::Held | Top::Free => 1.0,
            Top::Driven { filter: Some(_), .. } => return f64::INFINITY,
            Top::Continues { .. } | Top::Driven { .. } if beta == 0.0 && alpha == 0.0 => 1.0,
            Top::Continues { .. } | Top::Driven { .. } => (1.0 + FRAC_PI_4.sin()) / FRAC_PI_4.cos(),
        };
        let mut above: Option<f64> = None;
        for part in &self.parts {
            if let Some(above) = above {
                let step = ((above - part.impedance) / (above + part.impedance)).abs();
                let sign = if returned <= 1.0 { 1.0 } else { -1.0 };
                let denominator = 1.0 + sign * step * returned;
                returned = if denominator > 0.0 { (step + returned) / denominator } else { f64::INFINITY };
            }
            returned *= (-2.0 * rate * part.travel_time).exp();
            let damper = part.damper.abs() / part.impedance * (1.0 + returned);
            returned = if damper < 2.0 { (2.0 * returned + damper) / (2.0 - damper) } else { f64::INFINITY };
            above = Some(part.impedance);
        }
        match above {
            Some(impedance) if returned < 1.0 => (1.0 + returned) / ((1.0 - returned) * impedance * omega),
            _ => f64::INFINITY,
        }
    }
}
