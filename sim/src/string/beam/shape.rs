//! Interdependent interpolation of a Timoshenko beam: cubic deflection, quadratic rotation.

/// Values of the shape functions at one place of an element, in one bending plane.
///
/// The four functions belong to (deflection, rotation) of the upper node and of the lower one, for a plane
/// in which the slope is positive with the rotation. They solve the homogeneous static equations, so that their
/// stiffness is exact (Friedman and Kosmatka 1993).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Deflection N.
    pub deflection: [f64; 4],
    /// Slope of the deflection N' \[1/m\].
    pub slope: [f64; 4],
    /// Second derivative of the deflection N'' \[1/m2\].
    pub second: [f64; 4],
    /// Rotation of the section.
    pub rotation: [f64; 4],
    /// Derivative of the rotation \[1/m\].
    pub curvature: [f64; 4],
}

impl Shape {
    /// The functions at `xi` = z / l of an element of length `l` \[m\] with shear parameter `a`.
    pub fn at(xi: f64, l: f64, a: f64) -> Self {
        let c = 1.0 / (1.0 + a);
        let (x2, x3) = (xi * xi, xi * xi * xi);
        Self {
            deflection: [
                c * (2.0 * x3 - 3.0 * x2 - a * xi + 1.0 + a),
                c * l * (x3 - (2.0 + 0.5 * a) * x2 + (1.0 + 0.5 * a) * xi),
                c * (3.0 * x2 - 2.0 * x3 + a * xi),
                c * l * (x3 - (1.0 - 0.5 * a) * x2 - 0.5 * a * xi),
            ],
            slope: [
                c / l * (6.0 * x2 - 6.0 * xi - a),
                c * (3.0 * x2 - (4.0 + a) * xi + 1.0 + 0.5 * a),
                c / l * (6.0 * xi - 6.0 * x2 + a),
                c * (3.0 * x2 - (2.0 - a) * xi - 0.5 * a),
            ],
            second: [
                c / (l * l) * (12.0 * xi - 6.0),
                c / l * (6.0 * xi - 4.0 - a),
                c / (l * l) * (6.0 - 12.0 * xi),
                c / l * (6.0 * xi - 2.0 + a),
            ],
            rotation: [
                c / l * (6.0 * x2 - 6.0 * xi),
                c * (3.0 * x2 - (4.0 + a) * xi + 1.0 + a),
                c / l * (6.0 * xi - 6.0 * x2),
                c * (3.0 * x2 - (2.0 - a) * xi),
            ],
            curvature: [
                c / (l * l) * (12.0 * xi - 6.0),
                c / l * (6.0 * xi - 4.0 - a),
                c / (l * l) * (6.0 - 12.0 * xi),
                c / l * (6.0 * xi - 2.0 + a),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_functions_interpolate_the_nodal_values() {
        for a in [0.0, 0.3, 40.0] {
            let (top, bottom) = (Shape::at(0.0, 1.7, a), Shape::at(1.0, 1.7, a));
            for i in 0..4 {
                let unit = |j: usize| f64::from(u8::from(i == j));
                assert!((top.deflection[i] - unit(0)).abs() < 1e-14);
                assert!((top.rotation[i] - unit(1)).abs() < 1e-14);
                assert!((bottom.deflection[i] - unit(2)).abs() < 1e-14);
                assert!((bottom.rotation[i] - unit(3)).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn shear_strain_is_constant_and_balances_the_bending_moment() {
        // Statics of an unloaded Timoshenko element: G S_r gamma = -EI theta'' , i.e. gamma = -(a l^2 / 12) theta''.
        let (l, a) = (1.3, 0.7);
        for i in 0..4 {
            let strain = |xi: f64| {
                let s = Shape::at(xi, l, a);
                s.slope[i] - s.rotation[i]
            };
            let second_rotation = (Shape::at(1.0, l, a).curvature[i] - Shape::at(0.0, l, a).curvature[i]) / l;
            for xi in [0.0, 0.2, 0.9] {
                assert!((strain(xi) + a * l * l / 12.0 * second_rotation).abs() < 1e-13);
            }
        }
    }
}
