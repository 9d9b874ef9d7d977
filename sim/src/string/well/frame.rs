//! Section frames carried along the path without twist.

use nalgebra::Vector3;

use super::path::WellPath;

/// Sine of the inclination below which a section has no low side (docs/model/well.md, Frames of the nodes).
const VERTICAL: f64 = 1e-6;

/// The frame of one node in global coordinates: `e1` and `e2` span the section, `e1 x e2 = e3`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeFrame {
    /// Position of the hole's axis \[m\].
    pub position: Vector3<f64>,
    /// First lateral axis (displacement u).
    pub e1: Vector3<f64>,
    /// Second lateral axis (displacement v).
    pub e2: Vector3<f64>,
    /// Unit tangent, downhole (displacement w).
    pub e3: Vector3<f64>,
    /// Angle from e1 towards e2 of the low side, atan2(g.e2, g.e1) \[rad\]; 0 if the hole is
    /// vertical (inclination within 1e-6 rad of 0 or 180 deg) and has none.
    pub low_side_angle: f64,
}

impl WellPath {
    /// The frames at the given measured depths \[m\]. At the first of them e1 is the low side (north if
    /// the hole is vertical); to the others it is carried by parallel transport along the path, arc by
    /// arc, so that frames are free of twist and errors do not add up along the string.
    pub fn frames(&self, depths: &[f64]) -> Vec<NodeFrame> {
        let Some(&first) = depths.first() else { return Vec::new() };
        let (x, y) = self.transported_axes(first);
        let zero = zero_direction(&self.tangent(first));
        // Two parallel frames differ by a constant angle.
        let (along_x, along_y) = (zero.dot(&x), zero.dot(&y));
        let norm = along_x.hypot(along_y);
        let (cos, sin) = (along_x / norm, along_y / norm);

        depths
            .iter()
            .map(|&s| {
                let (x, y) = self.transported_axes(s);
                let (e1, e2) = (x * cos + y * sin, y * cos - x * sin);
                let low_side_angle = if e1.z.hypot(e2.z) < VERTICAL { 0.0 } else { e2.z.atan2(e1.z) };
                NodeFrame { position: self.position(s), e1, e2, e3: self.tangent(s), low_side_angle }
            })
            .collect()
    }

    /// The axes of the section at `s`, parallel to those of the first station.
    fn transported_axes(&self, s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let interval = self.interval(s);
        let distance = s - interval.top;
        let x = interval.arc.transport(&interval.reference, distance).normalize();
        (x, interval.arc.tangent(distance).cross(&x))
    }
}

/// Direction of e1 at the first node: the projection of gravity on the section, or of north if gravity has none.
fn zero_direction(tangent: &Vector3<f64>) -> Vector3<f64> {
    let horizontal = tangent.x.hypot(tangent.y);
    if horizontal < VERTICAL {
        return (Vector3::x() - tangent * tangent.x).normalize();
    }
    // g - (g.t) t divided by its length sin I, without the difference 1 - cos^2 I.
    Vector3::new(-tangent.z * tangent.x / horizontal, -tangent.z * tangent.y / horizontal, horizontal)
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::{SurveyStation, Well};

    use super::*;

    fn path(stations: &[(f64, f64, f64)]) -> WellPath {
        let survey = stations
            .iter()
            .map(|&(measured_depth, inclination_deg, azimuth_deg)| SurveyStation {
                measured_depth,
                inclination_deg,
                azimuth_deg,
            })
            .collect();
        WellPath::new(&Well { hole_diameter: 0.2159, survey, section: Vec::new() }).unwrap()
    }

    fn curved() -> WellPath {
        path(&[
            (0.0, 60.0, 0.0),
            (50.0, 71.0, 7.0),
            (100.0, 82.0, 14.0),
            (150.0, 90.0, 24.0),
            (200.0, 93.0, 36.0),
        ])
    }

    fn depths(count: u32, length: f64) -> Vec<f64> {
        (0..=count).map(|i| length * f64::from(i) / f64::from(count)).collect()
    }

    #[test]
    fn frames_are_right_handed_and_orthonormal() {
        for f in curved().frames(&depths(1000, 200.0)) {
            for (axis, other) in [(f.e1, f.e2), (f.e2, f.e3), (f.e3, f.e1)] {
                assert!((axis.norm() - 1.0).abs() < 1e-15 * 4.0);
                assert!(axis.dot(&other).abs() < 1e-15 * 4.0);
            }
            assert!((f.e1.cross(&f.e2) - f.e3).norm() < 1e-15 * 8.0);
        }
    }

    #[test]
    fn first_frame_looks_at_the_low_side() {
        let f = curved().frames(&[0.0])[0];
        // Inclination 60 deg heading north: the low side is straight below the axis, (-cos 60, 0, sin 60).
        let low = Vector3::new(-0.5, 0.0, 0.75_f64.sqrt());
        assert!((f.e1 - low).norm() < 1e-15);
        assert!(f.low_side_angle.abs() < 1e-15);
        // Looking downhole, a quarter turn clockwise from straight down is to the left: west.
        assert!((f.e2 + Vector3::y()).norm() < 1e-15);
    }

    #[test]
    fn vertical_holes_start_from_north() {
        for (inclination, e2) in [(0.0, Vector3::y()), (180.0, -Vector3::y()), (1e-5, Vector3::y())] {
            let f = path(&[(0.0, inclination, 70.0), (100.0, inclination, 70.0)]).frames(&[0.0, 60.0])[1];
            assert!((f.e1 - Vector3::x()).norm() < 2e-7, "{inclination}");
            assert!((f.e2 - e2).norm() < 2e-7);
            assert_eq!(f.low_side_angle, 0.0);
        }
        // Just beyond the limit, at either end, e1 is the low side.
        for inclination in [1e-4, 180.0 - 1e-4] {
            let f = path(&[(0.0, inclination, 70.0), (100.0, inclination, 70.0)]).frames(&[0.0])[0];
            let heading = Vector3::new(70.0_f64.to_radians().cos(), 70.0_f64.to_radians().sin(), 0.0);
            let sense = if inclination < 90.0 { -1.0 } else { 1.0 };
            assert!((f.e1 - heading * sense).norm() < 1e-5);
            assert!(f.low_side_angle.abs() < 1e-9);
        }
    }

    #[test]
    fn planar_holes_carry_their_low_side_along() {
        // A vertical plane has no geodesic torsion: the low side stays e1 all the way.
        let well = path(&[(0.0, 10.0, 30.0), (100.0, 50.0, 30.0), (180.0, 95.0, 30.0)]);
        for f in well.frames(&depths(50, 180.0)) {
            assert!(f.low_side_angle.abs() < 1e-14);
        }
    }

    #[test]
    fn transport_agrees_with_double_reflection() {
        // Wang, Juettler, Zheng and Liu (2008): the double reflection method, fourth order globally, shares
        // nothing with the closed form but the path.
        let well = curved();
        let error = |count: u32| {
            let depths = depths(count, 200.0);
            let exact = well.frames(&depths);
            let mut e1 = exact[0].e1;
            for pair in exact.windows(2) {
                let chord = pair[1].position - pair[0].position;
                let reflected = |v: Vector3<f64>, axis: Vector3<f64>| {
                    v - axis * (2.0 * axis.dot(&v) / axis.norm_squared())
                };
                let (e1_left, tangent_left) = (reflected(e1, chord), reflected(pair[0].e3, chord));
                e1 = reflected(e1_left, pair[1].e3 - tangent_left);
            }
            (e1 - exact[exact.len() - 1].e1).norm()
        };
        // Exact on circular arcs when the stations are among the depths: only rounding is left.
        assert!(error(400) < 1e-12, "{}", error(400));
    }

    #[test]
    fn transport_does_not_twist() {
        // e2 . de1/ds = 0 between the stations, by a central difference (error h^2 kappa^3 and rounding).
        let well = curved();
        let h = 1e-3;
        for s in [7.0, 61.0, 99.0, 140.0, 188.0] {
            let f = well.frames(&[0.0, s - h, s, s + h]);
            let twist = f[2].e2.dot(&(f[3].e1 - f[1].e1)) / (2.0 * h);
            assert!(twist.abs() < 1e-12, "{twist} 1/m at {s} m");
        }
    }

    #[test]
    fn low_side_turns_as_the_azimuth_demands() {
        // Along a path of inclination I and azimuth A the low side turns against a parallel frame by
        // int cos I dA (Gauss-Bonnet on the tangent's sphere), here by a fine sum over the path itself.
        let well = curved();
        let depths = depths(200_000, 200.0);
        let frames = well.frames(&depths);
        let mut turned = 0.0;
        for pair in frames.windows(2) {
            let azimuth = |t: &Vector3<f64>| t.y.atan2(t.x);
            turned += 0.5 * (pair[0].e3.z + pair[1].e3.z) * (azimuth(&pair[1].e3) - azimuth(&pair[0].e3));
        }
        let found = frames[frames.len() - 1].low_side_angle;
        // Midpoint sums of 1 mm: error below (h kappa)^2.
        assert!((found - turned).abs() < 1e-9, "{found} against {turned}");
    }
}
