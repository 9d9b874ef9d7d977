//! One circular arc between two survey stations.

use nalgebra::Vector3;

/// A direction of the hole. Kept in degrees as surveyed: the difference of two near angles is then exact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Direction {
    pub(super) inclination_deg: f64,
    pub(super) azimuth_deg: f64,
}

impl Direction {
    /// The unit tangent, pointing downhole.
    pub(super) fn tangent(self) -> Vector3<f64> {
        let (sin_i, cos_i) = self.inclination_deg.to_radians().sin_cos();
        let (sin_a, cos_a) = self.azimuth_deg.to_radians().sin_cos();
        Vector3::new(sin_i * cos_a, sin_i * sin_a, cos_i)
    }
}

/// An arc that starts in the direction of one station and ends in that of the next. A place on it is the
/// distance from its upper end \[m\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc {
    /// Unit tangent at the upper end.
    tangent: Vector3<f64>,
    /// Unit vector towards the centre of curvature at the upper end; zero if the arc is straight.
    normal: Vector3<f64>,
    /// Curvature \[1/m\].
    curvature: f64,
}

impl Arc {
    /// The arc of `length` \[m\] from `top` to `bottom`, or the dogleg \[rad\] if it turns back on itself so
    /// that no plane of bending is defined.
    pub(super) fn new(top: Direction, bottom: Direction, length: f64) -> Result<Self, f64> {
        // Components of the lower tangent on the upper station's own axes: along the tangent, towards larger
        // inclination and towards larger azimuth. Written with the angles' differences, they keep their
        // digits however small the dogleg is.
        let (sin_top, cos_top) = top.inclination_deg.to_radians().sin_cos();
        let sin_bottom = bottom.inclination_deg.to_radians().sin();
        let turn = (bottom.azimuth_deg - top.azimuth_deg).to_radians();
        let build = (bottom.inclination_deg - top.inclination_deg).to_radians();
        let versine = 2.0 * (0.5 * turn).sin().powi(2);
        let along = build.cos() - sin_top * sin_bottom * versine;
        let up = build.sin() - sin_bottom * cos_top * versine;
        let right = sin_bottom * turn.sin();

        let across = up.hypot(right);
        let dogleg = across.atan2(along);
        if along < 0.0 && across < LEAST_REVERSAL {
            return Err(dogleg);
        }
        let (sin_a, cos_a) = top.azimuth_deg.to_radians().sin_cos();
        let towards_up = Vector3::new(cos_top * cos_a, cos_top * sin_a, -sin_top);
        let towards_right = Vector3::new(-sin_a, cos_a, 0.0);
        let normal =
            if across > 0.0 { (towards_up * up + towards_right * right) / across } else { Vector3::zeros() };
        Ok(Self { tangent: top.tangent(), normal, curvature: dogleg / length })
    }

    /// Displacement from the upper end to the place.
    pub(super) fn displacement(&self, distance: f64) -> Vector3<f64> {
        // sin x / x and (1 - cos x) / x = sin(x/2) sinc(x/2) lose no digits as the arc straightens.
        let angle = self.curvature * distance;
        let sideways = (0.5 * angle).sin() * sinc(0.5 * angle);
        (self.tangent * sinc(angle) + self.normal * sideways) * distance
    }

    /// Unit tangent at the place.
    pub(super) fn tangent(&self, distance: f64) -> Vector3<f64> {
        let (sin, cos) = (self.curvature * distance).sin_cos();
        self.tangent * cos + self.normal * sin
    }

    /// Curvature vector at the place \[1/m\].
    pub(super) fn curvature(&self, distance: f64) -> Vector3<f64> {
        self.inward(distance) * self.curvature
    }

    /// Carries a vector of the upper end's section to the section at the place, by the rotation about the
    /// arc's binormal. The component of `vector` along the tangent is dropped.
    pub(super) fn transport(&self, vector: &Vector3<f64>, distance: f64) -> Vector3<f64> {
        if self.normal == Vector3::zeros() {
            return vector - self.tangent * vector.dot(&self.tangent);
        }
        let binormal = self.tangent.cross(&self.normal);
        binormal * vector.dot(&binormal) + self.inward(distance) * vector.dot(&self.normal)
    }

    /// Unit vector towards the centre at the place; zero if the arc is straight.
    fn inward(&self, distance: f64) -> Vector3<f64> {
        if self.normal == Vector3::zeros() {
            return self.normal;
        }
        let (sin, cos) = (self.curvature * distance).sin_cos();
        self.normal * cos - self.tangent * sin
    }
}

/// Sine of the angle to the exact reversal below which rounding alone would choose the plane of the arc.
const LEAST_REVERSAL: f64 = 1e-9;

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}
