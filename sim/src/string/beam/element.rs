//! Element matrices in the chord frame.

use super::matrix::{ElementMatrix, ElementVector};
use super::section::BeamSection;
use super::shape::Shape;
use crate::math::dof::{DOFS, THETA_X, THETA_Y, THETA_Z, U, V, W};

/// Four-point Gauss-Legendre rule on \[0, 1\]: (place, weight), exact to degree 7.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Degrees of freedom of the plane (u, theta_y) and their signs.
const PLANE_U: [(usize, f64); 4] = [(U, 1.0), (THETA_Y, 1.0), (DOFS + U, 1.0), (DOFS + THETA_Y, 1.0)];
/// Degrees of freedom of the plane (v, theta_x): a positive slope of v is a negative theta_x.
const PLANE_V: [(usize, f64); 4] = [(V, 1.0), (THETA_X, -1.0), (DOFS + V, 1.0), (DOFS + THETA_X, -1.0)];

/// One straight element: a section and a length. Matrices are in the chord frame. If a factor (tension,
/// torque, mass per length) is named, they are for that factor equal to one.
#[derive(Debug, Clone, Copy)]
pub struct BeamElement {
    section: BeamSection,
    length: f64,
    shear_parameter: f64,
}

/// Rows of the interpolation at one place: each maps the 12 nodal values to a field.
struct Rows {
    u: ElementVector,
    v: ElementVector,
    u_slope: ElementVector,
    v_slope: ElementVector,
    u_second: ElementVector,
    v_second: ElementVector,
    theta_x: ElementVector,
    theta_y: ElementVector,
    theta_x_derivative: ElementVector,
    theta_y_derivative: ElementVector,
}

impl BeamElement {
    /// An element of `length` \[m\].
    pub fn new(section: BeamSection, length: f64) -> Self {
        Self { section, length, shear_parameter: section.shear_parameter(length) }
    }

    /// The element's section.
    pub fn section(&self) -> &BeamSection {
        &self.section
    }

    /// Chord length \[m\].
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Shear parameter a of (6).
    pub fn shear_parameter(&self) -> f64 {
        self.shear_parameter
    }

    /// Elastic stiffness, equation (5) with the shear term of (6).
    pub fn stiffness(&self) -> ElementMatrix {
        let s = &self.section;
        let shear = s.shear_modulus * s.shear_area;
        let mut k = self.integrate(|r| {
            let (gx, gy) = (r.u_slope - r.theta_y, r.v_slope + r.theta_x);
            (outer(&r.theta_y_derivative, &r.theta_y_derivative)
                + outer(&r.theta_x_derivative, &r.theta_x_derivative))
                * s.bending_stiffness()
                + (outer(&gx, &gx) + outer(&gy, &gy)) * shear
        });
        for (dof, stiffness) in [(W, s.axial_stiffness()), (THETA_Z, s.torsional_stiffness())] {
            let c = stiffness / self.length;
            k[(dof, dof)] += c;
            k[(dof + DOFS, dof + DOFS)] += c;
            k[(dof, dof + DOFS)] -= c;
            k[(dof + DOFS, dof)] -= c;
        }
        k
    }

    /// Consistent structural mass: translation, rotary inertia, axial and torsional inertia.
    pub fn mass(&self) -> ElementMatrix {
        let s = &self.section;
        let mut m = self.lateral_mass() * (s.density * s.area)
            + self.integrate(|r| outer(&r.theta_x, &r.theta_x) + outer(&r.theta_y, &r.theta_y))
                * (s.density * s.second_moment);
        for (dof, inertia) in [(W, s.density * s.area), (THETA_Z, s.density * s.polar_moment())] {
            let c = inertia * self.length / 6.0;
            m[(dof, dof)] += 2.0 * c;
            m[(dof + DOFS, dof + DOFS)] += 2.0 * c;
            m[(dof, dof + DOFS)] += c;
            m[(dof + DOFS, dof)] += c;
        }
        m
    }

    /// Gyroscopic matrix for `rotation_speed` \[rad/s\]; multiplies the velocities, skew-symmetric. The equation of
    /// theta_x gains + rho I_p Omega int N_x^T N_y, that of theta_y the same with minus (equation (4), mended).
    pub fn gyroscopic(&self, rotation_speed: f64) -> ElementMatrix {
        self.integrate(|r| outer(&r.theta_x, &r.theta_y) - outer(&r.theta_y, &r.theta_x))
            * (self.section.density * self.section.polar_moment() * rotation_speed)
    }

    /// Stiffening by an effective tension of 1 N, equation (8): int(N_u'^T N_u' + N_v'^T N_v').
    pub fn tension_stiffening(&self) -> ElementMatrix {
        self.integrate(|r| outer(&r.u_slope, &r.u_slope) + outer(&r.v_slope, &r.v_slope))
    }

    /// Stiffening by an internal torque of 1 N m, equation (9): rows u, columns v + int N_u''^T N_v'; rows v,
    /// columns u - int N_v''^T N_u'.
    pub fn torque_stiffening(&self) -> ElementMatrix {
        self.integrate(|r| outer(&r.u_second, &r.v_slope) - outer(&r.v_second, &r.u_slope))
    }

    /// Lateral mass (or damping) matrix of 1 per length: int(N_u^T N_u + N_v^T N_v).
    pub fn lateral_mass(&self) -> ElementMatrix {
        self.integrate(|r| outer(&r.u, &r.u) + outer(&r.v, &r.v))
    }

    /// Coriolis matrix of 1 kg/s: int(N_u^T N_u' + N_v^T N_v'), the derivative on the trial function (A.2, mended).
    pub fn coriolis(&self) -> ElementMatrix {
        self.integrate(|r| outer(&r.u, &r.u_slope) + outer(&r.v, &r.v_slope))
    }

    /// End term N(l)^T N'(l) of a flow that leaves the element's lower end freely (docs/model/mud.md, Flow stiffness).
    pub fn flow_end(&self) -> ElementMatrix {
        let r = self.rows(1.0);
        outer(&r.u, &r.u_slope) + outer(&r.v, &r.v_slope)
    }

    /// Consistent nodal loads of a distributed load (x, y, z) \[N/m\], constant along the chord.
    pub fn distributed_load(&self, load: [f64; 3]) -> ElementVector {
        let mut f = ElementVector::zeros();
        for (xi, weight) in GAUSS {
            let r = self.rows(xi);
            f += (r.u * load[0] + r.v * load[1]) * (weight * self.length);
        }
        f[W] += 0.5 * load[2] * self.length;
        f[DOFS + W] += 0.5 * load[2] * self.length;
        f
    }

    /// Row that maps the 12 nodal values to the axial force E S w' \[N/m\].
    pub fn tension_row(&self) -> ElementVector {
        difference_row(W, self.section.axial_stiffness() / self.length)
    }

    /// Row that maps the 12 nodal values to the torque G I_p theta_z' \[N m/rad\].
    pub fn torque_row(&self) -> ElementVector {
        difference_row(THETA_Z, self.section.torsional_stiffness() / self.length)
    }

    /// Rows that map the 12 nodal values to the bending moments E I theta_y' and E I theta_x' \[N m\] at the place `xi` from 0 to 1.
    pub fn bending_rows(&self, xi: f64) -> [ElementVector; 2] {
        let rows = self.rows(xi);
        [rows.theta_y_derivative, rows.theta_x_derivative].map(|row| row * self.section.bending_stiffness())
    }

    fn integrate(&self, integrand: impl Fn(&Rows) -> ElementMatrix) -> ElementMatrix {
        GAUSS.iter().fold(ElementMatrix::zeros(), |sum, &(xi, weight)| {
            sum + integrand(&self.rows(xi)) * (weight * self.length)
        })
    }

    fn rows(&self, xi: f64) -> Rows {
        let s = Shape::at(xi, self.length, self.shear_parameter);
        Rows {
            u: scatter(&PLANE_U, &s.deflection, 1.0),
            v: scatter(&PLANE_V, &s.deflection, 1.0),
            u_slope: scatter(&PLANE_U, &s.slope, 1.0),
            v_slope: scatter(&PLANE_V, &s.slope, 1.0),
            u_second: scatter(&PLANE_U, &s.second, 1.0),
            v_second: scatter(&PLANE_V, &s.second, 1.0),
            theta_y: scatter(&PLANE_U, &s.rotation, 1.0),
            theta_x: scatter(&PLANE_V, &s.rotation, -1.0),
            theta_y_derivative: scatter(&PLANE_U, &s.curvature, 1.0),
            theta_x_derivative: scatter(&PLANE_V, &s.curvature, -1.0),
        }
    }
}

fn outer(a: &ElementVector, b: &ElementVector) -> ElementMatrix {
    a * b.transpose()
}

fn scatter(plane: &[(usize, f64); 4], values: &[f64; 4], sign: f64) -> ElementVector {
    let mut row = ElementVector::zeros();
    for (&(dof, dof_sign), value) in plane.iter().zip(values) {
        row[dof] = sign * dof_sign * value;
    }
    row
}

fn difference_row(dof: usize, factor: f64) -> ElementVector {
    let mut row = ElementVector::zeros();
    row[dof] = -factor;
    row[dof + DOFS] = factor;
    row
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::Material;

    use super::*;

    fn element() -> BeamElement {
        let steel = Material { youngs_modulus: 2.03e11, density: 7900.0, poissons_ratio: 0.3, grade: None };
        BeamElement::new(BeamSection::pipe(0.159, 0.071, &steel), 0.5)
    }

    #[test]
    fn stiffness_is_the_closed_form_of_a_timoshenko_element() {
        let e = element();
        let (l, a, ei) = (e.length, e.shear_parameter, e.section.bending_stiffness());
        let c = ei / ((1.0 + a) * l.powi(3));
        let plane = [
            [12.0, 6.0 * l, -12.0, 6.0 * l],
            [6.0 * l, (4.0 + a) * l * l, -6.0 * l, (2.0 - a) * l * l],
            [-12.0, -6.0 * l, 12.0, -6.0 * l],
            [6.0 * l, (2.0 - a) * l * l, -6.0 * l, (4.0 + a) * l * l],
        ];
        let k = e.stiffness();
        for dofs in [PLANE_U, PLANE_V] {
            for i in 0..4 {
                for j in 0..4 {
                    let expected = c * plane[i][j] * dofs[i].1 * dofs[j].1;
                    let got = k[(dofs[i].0, dofs[j].0)];
                    assert!((got - expected).abs() < 1e-12 * c * 12.0, "{i} {j}: {got} {expected}");
                }
            }
        }
    }

    #[test]
    fn rigid_motions_cost_no_force_and_carry_the_whole_mass() {
        let e = element();
        let l = e.length;
        let mut rotation = ElementVector::zeros();
        // A rigid turn about x through the upper node: theta_x = 1, v = -z.
        rotation[3] = 1.0;
        rotation[9] = 1.0;
        rotation[7] = -l;
        let k = e.stiffness();
        assert!((k * rotation).norm() < 1e-9 * k.norm());
        let m = e.mass();
        let s = e.section();
        for dof in 0..3 {
            let mut shift = ElementVector::zeros();
            shift[dof] = 1.0;
            shift[dof + DOFS] = 1.0;
            let mass = shift.dot(&(m * shift));
            assert!((mass - s.density * s.area * l).abs() < 1e-12 * mass);
        }
        let inertia = rotation.dot(&(m * rotation));
        let expected = s.density * (s.area * l.powi(3) / 3.0 + s.second_moment * l);
        assert!((inertia - expected).abs() < 1e-12 * expected);
    }

    #[test]
    fn gyroscopic_matrix_is_skew_and_couples_theta_x_to_the_rate_of_theta_y() {
        let e = element();
        let g = e.gyroscopic(3.0);
        assert!((g + g.transpose()).norm() < 1e-14 * g.norm());
        let (mut x, mut y) = (ElementVector::zeros(), ElementVector::zeros());
        for dof in [3, 9] {
            x[dof] = 1.0;
        }
        x[7] = -e.length;
        for dof in [4, 10] {
            y[dof] = 1.0;
        }
        y[6] = e.length;
        let expected = e.section.density * e.section.polar_moment() * 3.0 * e.length;
        assert!((x.dot(&(g * y)) - expected).abs() < 1e-12 * expected);
    }

    #[test]
    fn tension_stiffening_of_a_rigid_slope_is_tension_times_slope() {
        let e = element();
        let mut slope = ElementVector::zeros();
        slope[4] = 1.0;
        slope[10] = 1.0;
        slope[6] = e.length;
        let f = e.tension_stiffening() * slope;
        assert!((f[6] - 1.0).abs() < 1e-13 && (f[0] + 1.0).abs() < 1e-13);
        assert!(f[4].abs() < 1e-13 && f[10].abs() < 1e-13);
    }

    #[test]
    fn distributed_load_is_the_textbook_consistent_load() {
        let e = element();
        let (l, q) = (e.length, 7.0);
        let f = e.distributed_load([q, -2.0 * q, 3.0 * q]);
        assert!((f[0] - q * l / 2.0).abs() < 1e-13 && (f[4] - q * l * l / 12.0).abs() < 1e-13);
        assert!((f[10] + q * l * l / 12.0).abs() < 1e-13);
        assert!(
            (f[9] + 2.0 * q * l * l / 12.0).abs() < 1e-13 && (f[3] - 2.0 * q * l * l / 12.0).abs() < 1e-13
        );
        assert!((f[8] - 1.5 * q * l).abs() < 1e-13);
    }
}
