//! Motion between the two ends of a step.

/// Displacements and velocities at the part `theta` of a step of `h` seconds, from displacement, velocity and acceleration at its
/// start and at its end: the polynomial of degree 5 with these six values (quintic Hermite interpolation), whose error is of order
/// h^6 in displacements and h^5 in velocities.
pub(crate) fn within<const D: usize>(
    h: f64,
    theta: f64,
    [x0, v0, a0]: &[[f64; D]; 3],
    [x1, v1, a1]: &[[f64; D]; 3],
) -> ([f64; D], [f64; D]) {
    // Without the Taylor polynomial of the start, the three values at the end fix the three highest powers.
    let mut x = [0.0; D];
    let mut v = [0.0; D];
    for dof in 0..D {
        let (v0, a0) = (h * v0[dof], h * h * a0[dof]);
        let displacement = x1[dof] - x0[dof] - v0 - 0.5 * a0;
        let velocity = h * v1[dof] - v0 - a0;
        let acceleration = h * h * a1[dof] - a0;
        let third = 10.0 * displacement - 4.0 * velocity + 0.5 * acceleration;
        let fourth = -15.0 * displacement + 7.0 * velocity - acceleration;
        let fifth = 6.0 * displacement - 3.0 * velocity + 0.5 * acceleration;
        let polynomial =
            |powers: [f64; 6]| powers.iter().rev().fold(0.0, |sum: f64, power| sum.mul_add(theta, *power));
        x[dof] = polynomial([x0[dof], v0, 0.5 * a0, third, fourth, fifth]);
        v[dof] = polynomial([v0, a0, 3.0 * third, 4.0 * fourth, 5.0 * fifth, 0.0]) / h;
    }
    (x, v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_of_degree_five_is_met_everywhere() {
        let c = [0.3, -1.2, 0.7, 2.1, -0.4, 0.9];
        let x = |t: f64| (0..6).map(|k| c[k] * t.powi(k as i32)).sum::<f64>();
        let v = |t: f64| (1..6).map(|k| k as f64 * c[k] * t.powi(k as i32 - 1)).sum::<f64>();
        let a = |t: f64| (2..6).map(|k| (k * (k - 1)) as f64 * c[k] * t.powi(k as i32 - 2)).sum::<f64>();
        let (t0, h) = (0.2, 1.7);
        let at = |t: f64| [[x(t)], [v(t)], [a(t)]];
        for theta in [0.0, 0.13, 0.5, 0.9, 1.0] {
            let ([got], [rate]) = within(h, theta, &at(t0), &at(t0 + h));
            let t = t0 + theta * h;
            assert!((got - x(t)).abs() < 1e-13 && (rate - v(t)).abs() < 1e-12, "{theta}: {got} {rate}");
        }
    }
}
