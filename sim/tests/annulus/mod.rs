//! Exact flows in annuli, for comparison: Newtonian and eccentric; yield-power-law and concentric, with or
//! without rotation of the inner wall.

#![allow(unreachable_pub)]

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

/// Piercy's flow rate (1933) for R_o = 1, R_i = kappa, gradient and viscosity 1.
pub fn piercy_flow_rate(inner: f64, eccentricity: f64) -> f64 {
    let concentric = PI / 8.0 * (1.0 - inner.powi(4) - (1.0 - inner * inner).powi(2) / (1.0 / inner).ln());
    if eccentricity == 0.0 {
        return concentric;
    }
    let d = eccentricity * (1.0 - inner);
    let f = (1.0 - inner * inner + d * d) / (2.0 * d);
    let m = (f * f - 1.0).sqrt();
    let alpha = 0.5 * ((f + m) / (f - m)).ln();
    let beta = 0.5 * ((f - d + m) / (f - d - m)).ln();
    let series: f64 = (1..2000)
        .map(f64::from)
        .map(|k| k * (-k * (alpha + beta)).exp() / (k * (beta - alpha)).sinh())
        .take_while(|term| *term > 1e-18)
        .sum();
    PI / 8.0 * (1.0 - inner.powi(4) - 4.0 * d * d * m * m / (beta - alpha) - 8.0 * d * d * m * m * series)
}

/// tau = tau_y + K gamma^n.
#[derive(Debug, Clone, Copy)]
pub struct YieldPowerLaw {
    pub yield_stress: f64,
    pub consistency: f64,
    pub flow_index: f64,
}

impl YieldPowerLaw {
    fn shear_rate(&self, stress: f64) -> f64 {
        ((stress - self.yield_stress).max(0.0) / self.consistency).powf(1.0 / self.flow_index)
    }
}

/// A concentric annulus with a fluid in it.
#[derive(Debug, Clone, Copy)]
pub struct Annulus {
    pub inner_radius: f64,
    pub outer_radius: f64,
    pub fluid: YieldPowerLaw,
}

/// Axial flow under a given gradient.
pub struct AxialFlow {
    pub zero_stress_radius: f64,
    pub flow_rate: f64,
}

impl Annulus {
    /// Flow without rotation: tau = G/2 (r - lambda^2/r), lambda from no slip at both walls.
    pub fn axial_flow(&self, gradient: f64) -> AxialFlow {
        let stress = |r: f64, lambda: f64| 0.5 * gradient * (r - lambda * lambda / r);
        let integral = |lambda: f64, moment: i32| {
            // Both walls of the plug: |tau| = tau_y.
            let root = self.fluid.yield_stress.hypot(gradient * lambda);
            let plug_inner = ((root - self.fluid.yield_stress) / gradient).max(self.inner_radius);
            let plug_outer = ((root + self.fluid.yield_stress) / gradient).min(self.outer_radius);
            let rate = |r: f64| r.powi(moment) * self.fluid.shear_rate(stress(r, lambda).abs());
            from_plug(plug_outer, self.outer_radius, rate) + from_plug(plug_inner, self.inner_radius, rate)
        };
        let lambda = bisect(self.inner_radius, self.outer_radius, |lambda| -integral(lambda, 0));
        AxialFlow { zero_stress_radius: lambda, flow_rate: PI * integral(lambda, 2) }
    }

    /// Gradient of the flow without rotation that carries `flow_rate`.
    pub fn axial_gradient(&self, flow_rate: f64) -> f64 {
        let mut high = 1.0;
        while self.axial_flow(high).flow_rate < flow_rate {
            high *= 2.0;
        }
        bisect(0.5 * high, high, |gradient| self.axial_flow(gradient).flow_rate - flow_rate)
    }

    /// Gradient of the flow that carries `flow_rate` while the inner wall turns at `rotation_speed`:
    /// tau_rz = G/2 (r - lambda^2/r), tau_rtheta = c / r^2. The mean speed must shear the whole gap.
    pub fn helical_gradient(&self, flow_rate: f64, rotation_speed: f64) -> f64 {
        let gap = self.outer_radius - self.inner_radius;
        let mean_radius = 0.5 * (self.outer_radius + self.inner_radius);
        let speed = flow_rate / (2.0 * PI * mean_radius * gap);
        let cells = 4000;
        let dr = gap / f64::from(cells);
        // Unknowns: G, lambda^2, c; residuals scaled to 1.
        let residual = |unknown: Vector3<f64>| {
            let mut sums = Vector3::new(0.0, -1.0, -1.0);
            for cell in 0..cells {
                let r = self.inner_radius + (f64::from(cell) + 0.5) * dr;
                let axial = 0.5 * unknown[0] * (r - unknown[1] / r);
                let tangential = unknown[2] / (r * r);
                let stress = axial.hypot(tangential);
                let fluidity = self.fluid.shear_rate(stress) / stress;
                sums[0] += fluidity * axial * dr / speed;
                sums[1] += PI * r * r * fluidity * axial * dr / flow_rate;
                sums[2] += fluidity * tangential / r * dr / rotation_speed;
            }
            sums
        };
        // Newton from the viscosity at the walls' Newtonian shear rates, backtracking on the residual.
        let rate = (6.0 * speed / gap).hypot(rotation_speed * self.inner_radius / gap);
        let viscosity =
            (self.fluid.yield_stress + self.fluid.consistency * rate.powf(self.fluid.flow_index)) / rate;
        let mut at = Vector3::new(
            12.0 * viscosity * speed / (gap * gap),
            self.inner_radius * self.outer_radius,
            viscosity * rotation_speed * self.inner_radius * mean_radius.powi(2) / gap,
        );
        let mut here = residual(at);
        for _ in 0..50 {
            let columns = [0, 1, 2].map(|i| {
                let h = 1e-6 * at[i];
                let mut shifted = at;
                shifted[i] += h;
                let mut other = at;
                other[i] -= h;
                (residual(shifted) - residual(other)) / (2.0 * h)
            });
            let step = Matrix3::from_columns(&columns).lu().solve(&here).expect("a regular system");
            let mut fraction = 1.0;
            while residual(at - fraction * step).norm() > here.norm() && fraction > 1e-3 {
                fraction *= 0.5;
            }
            at -= fraction * step;
            here = residual(at);
            if here.norm() < 1e-11 {
                return at[0];
            }
        }
        panic!("no helical flow found: {here}");
    }
}

/// Integral outward from the plug's wall to the annulus' wall, either way round; the sign follows the direction
/// of the stress. The variable is squared, for the integrand is not smooth at the plug.
fn from_plug(plug: f64, wall: f64, integrand: impl Fn(f64) -> f64) -> f64 {
    let intervals = 800;
    let h = 1.0 / f64::from(intervals);
    let width = wall - plug;
    let value = |s: f64| 2.0 * s * width * integrand(plug + width * s * s);
    (0..intervals)
        .map(|i| f64::from(i) * h)
        .map(|s| (value(s) + 4.0 * value(s + h / 2.0) + value(s + h)) * h / 6.0)
        .sum()
}

/// Root of an increasing function.
fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
