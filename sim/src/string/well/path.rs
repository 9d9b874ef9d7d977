//! The path through all stations.

use drillsweep_scenario::{SurveyStation, Well};
use nalgebra::Vector3;

use super::arc::{Arc, Direction};

/// A survey that cannot be turned into a path. Stations are counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WellError {
    /// The survey has one station or none.
    #[error("a survey needs at least 2 stations, got {0}")]
    TooFewStations(usize),
    /// A station holds a number that is not finite.
    #[error("station {0} holds a number that is not finite")]
    NotFinite(usize),
    /// A station does not lie below the one before it.
    #[error("station {station} is at {measured_depth} m, not below the one before it at {previous} m")]
    NotIncreasing {
        /// The lower station.
        station: usize,
        /// Its measured depth \[m\].
        measured_depth: f64,
        /// The measured depth of the station before it \[m\].
        previous: f64,
    },
    /// The hole turns back on itself between two stations.
    #[error("the hole turns by {dogleg_deg} deg between stations {} and {station}; it must be below 180", station - 1)]
    Reversal {
        /// The lower station.
        station: usize,
        /// The dogleg \[deg\].
        dogleg_deg: f64,
    },
}

/// A well path by minimum curvature. Depths `s` are measured depths \[m\] as in the survey; above the first
/// and below the last station the end arcs continue.
#[derive(Debug, Clone)]
pub struct WellPath {
    intervals: Vec<Interval>,
    /// Measured depth of the last station \[m\].
    bottom: f64,
}

/// The arc below one station, with the quantities carried from the first station to its upper end.
#[derive(Debug, Clone)]
pub(super) struct Interval {
    /// Measured depth of the upper end \[m\].
    pub(super) top: f64,
    /// Position of the upper end \[m\].
    position: Vector3<f64>,
    /// A unit vector of the section, parallel along the whole path.
    pub(super) reference: Vector3<f64>,
    pub(super) arc: Arc,
}

impl WellPath {
    /// The path of a well.
    ///
    /// ```
    /// use drillsweep_scenario::{SurveyStation, Well};
    /// use drillsweep_sim::string::well::WellPath;
    ///
    /// // A quarter of a circle of 100 m from vertical to horizontal, by its two ends.
    /// let radius = 100.0;
    /// let quarter = radius * std::f64::consts::FRAC_PI_2;
    /// let station = |measured_depth, inclination_deg| SurveyStation { measured_depth, inclination_deg, azimuth_deg: 0.0 };
    /// let survey = vec![station(0.0, 0.0), station(quarter, 90.0)];
    /// let path = WellPath::new(&Well { hole_diameter: 0.2, survey, section: Vec::new() })?;
    /// assert!((path.true_vertical_depth(quarter) - radius).abs() < 1e-9);
    /// let third = radius * (1.0 - f64::to_radians(30.0).cos());
    /// assert!((path.position(quarter / 3.0).x.hypot(path.position(quarter / 3.0).y) - third).abs() < 1e-9);
    /// # Ok::<(), drillsweep_sim::string::well::WellError>(())
    /// ```
    ///
    /// # Errors
    /// There are fewer than two stations, a number is not finite, depths do not increase, or an interval
    /// has a dogleg of 180 deg, which leaves the arc's plane undefined.
    pub fn new(well: &Well) -> Result<Self, WellError> {
        let survey = &well.survey;
        if survey.len() < 2 {
            return Err(WellError::TooFewStations(survey.len()));
        }
        let finite = |station: &SurveyStation| {
            [station.measured_depth, station.inclination_deg, station.azimuth_deg]
                .iter()
                .all(|x| x.is_finite())
        };
        if let Some(station) = survey.iter().position(|station| !finite(station)) {
            return Err(WellError::NotFinite(station));
        }
        let directions: Vec<Direction> = survey
            .iter()
            .map(|station| Direction {
                inclination_deg: station.inclination_deg,
                azimuth_deg: station.azimuth_deg,
            })
            .collect();

        let mut intervals = Vec::with_capacity(survey.len() - 1);
        let mut position = Vector3::zeros();
        let mut reference = any_normal(&directions[0].tangent());
        for station in 1..survey.len() {
            let (top, bottom) = (survey[station - 1].measured_depth, survey[station].measured_depth);
            if bottom <= top {
                return Err(WellError::NotIncreasing { station, measured_depth: bottom, previous: top });
            }
            let length = bottom - top;
            let arc = Arc::new(directions[station - 1], directions[station], length)
                .map_err(|dogleg| WellError::Reversal { station, dogleg_deg: dogleg.to_degrees() })?;
            intervals.push(Interval { top, position, reference, arc });
            position += arc.displacement(length);
            reference = arc.transport(&reference, length).normalize();
        }
        Ok(Self { intervals, bottom: survey[survey.len() - 1].measured_depth })
    }

    /// Length of the path \[m\].
    pub fn length(&self) -> f64 {
        self.bottom - self.intervals[0].top
    }

    /// Position r(s) \[m\]: X north, Y east, Z down, origin at the first station.
    pub fn position(&self, s: f64) -> Vector3<f64> {
        let interval = self.interval(s);
        interval.position + interval.arc.displacement(s - interval.top)
    }

    /// Unit tangent t(s) = dr/ds, pointing downhole.
    pub fn tangent(&self, s: f64) -> Vector3<f64> {
        let interval = self.interval(s);
        interval.arc.tangent(s - interval.top)
    }

    /// Curvature vector kappa(s) = dt/ds \[1/m\]. It jumps at a station; there it is that of the interval below
    /// (at the last station that of the interval above).
    pub fn curvature(&self, s: f64) -> Vector3<f64> {
        let interval = self.interval(s);
        interval.arc.curvature(s - interval.top)
    }

    /// Unit tangent and curvature vector \[1/m\] at `s`, on the arc that holds `within`: at a station the two arcs have curvatures of their own.
    pub(crate) fn on_arc(&self, within: f64, s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let interval = self.interval(within);
        (interval.arc.tangent(s - interval.top), interval.arc.curvature(s - interval.top))
    }

    /// Measured depths of the stations but the last one \[m\].
    pub(crate) fn stations(&self) -> impl Iterator<Item = f64> {
        self.intervals.iter().map(|interval| interval.top)
    }

    /// True vertical depth below the first station \[m\].
    pub fn true_vertical_depth(&self, s: f64) -> f64 {
        self.position(s).z
    }

    /// The interval that holds `s`.
    pub(super) fn interval(&self, s: f64) -> &Interval {
        let below = self.intervals.partition_point(|interval| interval.top <= s);
        &self.intervals[below.saturating_sub(1)]
    }
}

/// A unit vector normal to a unit vector.
fn any_normal(tangent: &Vector3<f64>) -> Vector3<f64> {
    let least = tangent.iamin();
    let axis = Vector3::ith(least, 1.0);
    (axis - tangent * tangent[least]).normalize()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn well(stations: &[(f64, f64, f64)]) -> Well {
        let survey = stations
            .iter()
            .map(|&(measured_depth, inclination_deg, azimuth_deg)| SurveyStation {
                measured_depth,
                inclination_deg,
                azimuth_deg,
            })
            .collect();
        Well { hole_diameter: 0.2159, survey, section: Vec::new() }
    }

    fn path(stations: &[(f64, f64, f64)]) -> WellPath {
        WellPath::new(&well(stations)).unwrap()
    }

    /// The reconstruction of the paper's well (docs/model/index.md, Base case).
    const PAPER: [(f64, f64, f64); 5] =
        [(0.0, 60.0, 0.0), (50.0, 71.0, 7.0), (100.0, 82.0, 14.0), (150.0, 90.0, 24.0), (200.0, 93.0, 36.0)];

    #[test]
    fn quarter_circle_in_a_vertical_plane() {
        // From vertical to horizontal, heading east, radius R: r = R (0, 1 - cos x, sin x), x = s/R.
        let radius = 80.0;
        let well = path(&[(0.0, 0.0, 90.0), (radius * FRAC_PI_2, 90.0, 90.0)]);
        for i in 0..=20 {
            let x = f64::from(i) / 20.0 * FRAC_PI_2;
            let expected = Vector3::new(0.0, 1.0 - x.cos(), x.sin()) * radius;
            assert!((well.position(radius * x) - expected).norm() < 1e-12 * radius);
            assert!((well.tangent(radius * x) - Vector3::new(0.0, x.sin(), x.cos())).norm() < 1e-14);
            let towards_centre = Vector3::new(0.0, x.cos(), -x.sin());
            assert!((well.curvature(radius * x) - towards_centre / radius).norm() < 1e-15);
        }
        assert!((well.true_vertical_depth(well.length()) - radius).abs() < 1e-12 * radius);
    }

    #[test]
    fn arc_in_a_horizontal_plane() {
        // Turning right from north at constant inclination 90 deg: r = R (sin x, 1 - cos x, 0).
        let radius = 120.0;
        let well = path(&[(10.0, 90.0, 350.0), (10.0 + radius * PI / 3.0, 90.0, 410.0)]);
        let start = (-10.0_f64).to_radians();
        for i in 0..=12 {
            let x = f64::from(i) / 12.0 * PI / 3.0;
            let expected =
                Vector3::new((start + x).sin() - start.sin(), start.cos() - (start + x).cos(), 0.0) * radius;
            assert!((well.position(10.0 + radius * x) - expected).norm() < 1e-12 * radius);
        }
    }

    #[test]
    fn position_is_the_integral_of_the_tangent() {
        // Simpson's rule on 2000 panels of each interval: its error (h kappa)^4 is far below rounding.
        let well = path(&PAPER);
        let panels = 2000;
        for interval in PAPER.windows(2) {
            let (top, bottom) = (interval[0].0, interval[1].0);
            let h = (bottom - top) / f64::from(panels);
            let mut integral = Vector3::zeros();
            for i in 0..panels {
                let s = top + f64::from(i) * h;
                // The upper station belongs to this interval, like every place within it; the last
                // place is approached from inside.
                let end = if i + 1 == panels { bottom - 1e-13 } else { s + h };
                integral +=
                    (well.tangent(s) + well.tangent(s + 0.5 * h) * 4.0 + well.tangent(end)) * (h / 6.0);
            }
            assert!((well.position(bottom) - well.position(top) - integral).norm() < 1e-11);
        }
    }

    #[test]
    fn tangent_is_continuous_and_meets_the_stations() {
        let well = path(&PAPER);
        for &(s, inclination, azimuth) in &PAPER {
            let (i, a) = (inclination.to_radians(), azimuth.to_radians());
            let surveyed = Vector3::new(i.sin() * a.cos(), i.sin() * a.sin(), i.cos());
            for side in [s - 1e-12, s, s + 1e-12] {
                assert!((well.tangent(side) - surveyed).norm() < 1e-13, "at {s} m");
            }
        }
    }

    #[test]
    fn curvature_is_the_derivative_of_the_tangent() {
        let well = path(&PAPER);
        let h = 1e-3;
        for s in [3.0, 49.0, 77.7, 149.9, 199.0] {
            let difference = (well.tangent(s + h) - well.tangent(s - h)) / (2.0 * h);
            // Central difference: error kappa (h kappa)^2 / 6 and rounding 1e-16 / h.
            assert!((well.curvature(s) - difference).norm() < 1e-12);
            assert!(well.curvature(s).dot(&well.tangent(s)).abs() < 1e-17);
        }
        // At a station the interval below counts, at the last one the interval above.
        assert!((well.curvature(50.0) - well.curvature(50.0 + 1e-9)).norm() < 1e-12);
        assert!((well.curvature(50.0) - well.curvature(50.0 - 1e-9)).norm() > 1e-5);
        assert!((well.curvature(200.0) - well.curvature(200.0 - 1e-9)).norm() < 1e-12);
    }

    #[test]
    fn published_minimum_curvature_example() {
        // drillingformulas.com, "Minimum Curvature Method": 15 deg / 20 deg to 25 deg / 45 deg over 100 ft gives
        // 27.22 ft north, 19.45 ft east, 94.01 ft down and a dogleg of 0.22605 rad, as printed.
        let well = path(&[(3500.0, 15.0, 20.0), (3600.0, 25.0, 45.0)]);
        let expected = Vector3::new(27.22, 19.45, 94.01);
        assert!((well.position(3600.0) - expected).amax() < 0.005 + 1e-9);
        assert!((well.curvature(3550.0).norm() * 100.0 - 0.22605).abs() < 5e-6);
    }

    #[test]
    fn doglegs_of_the_papers_reconstructed_well() {
        // 7.4 to 7.8 deg per 30 m, as it was made.
        let well = path(&PAPER);
        let mut severities: Vec<f64> =
            [25.0, 75.0, 125.0, 175.0].map(|s| well.curvature(s).norm().to_degrees() * 30.0).to_vec();
        severities.sort_by(f64::total_cmp);
        assert!((severities[0] - 7.4).abs() < 0.05 && (severities[3] - 7.8).abs() < 0.05, "{severities:?}");
    }

    #[test]
    fn nearly_straight_intervals_keep_their_digits() {
        // Dogleg epsilon: the offset is epsilon L / 2 (1 - epsilon^2 / 12 ...), to all digits.
        for epsilon_deg in [1e-3, 1e-6, 1e-9, 1e-12] {
            let well = path(&[(0.0, 40.0, 20.0), (30.0, 40.0, 20.0 + epsilon_deg)]);
            // Constant inclination, small turn: the dogleg is sin I times the turn.
            let turn = (20.0 + epsilon_deg - 20.0_f64).to_radians();
            let dogleg = turn * 40.0_f64.to_radians().sin();
            let relative = (well.curvature(10.0).norm() * 30.0 - dogleg).abs() / dogleg;
            assert!(relative < 1e-10, "dogleg off by {relative} at {epsilon_deg} deg");
            let sideways = well.position(30.0).dot(&Vector3::new(
                -(20.0_f64.to_radians().sin()),
                20.0_f64.to_radians().cos(),
                0.0,
            ));
            // The dot product itself rounds at 30 m x 2e-16.
            assert!((sideways - 15.0 * dogleg).abs() < 1e-10 * dogleg + 2e-14);
        }
        let straight = path(&[(0.0, 40.0, 20.0), (30.0, 40.0, 20.0)]);
        assert_eq!(straight.curvature(10.0), Vector3::zeros());
        assert!((straight.position(30.0) - straight.tangent(0.0) * 30.0).norm() < 1e-14);
    }

    #[test]
    fn impossible_surveys_are_refused() {
        let refused = |stations: &[(f64, f64, f64)]| WellPath::new(&well(stations)).unwrap_err();
        assert_eq!(refused(&[(0.0, 10.0, 0.0)]), WellError::TooFewStations(1));
        assert_eq!(refused(&[(0.0, 10.0, 0.0), (30.0, f64::NAN, 0.0)]), WellError::NotFinite(1));
        assert!(matches!(
            refused(&[(0.0, 10.0, 0.0), (30.0, 11.0, 0.0), (30.0, 12.0, 0.0)]),
            WellError::NotIncreasing { station: 2, .. }
        ));
        assert!(matches!(
            refused(&[(0.0, 90.0, 10.0), (30.0, 90.0, 190.0)]),
            WellError::Reversal { station: 1, .. }
        ));
        assert!(matches!(
            refused(&[(0.0, 0.0, 0.0), (30.0, 180.0, 0.0)]),
            WellError::Reversal { station: 1, .. }
        ));
        assert!(WellPath::new(&well(&[(0.0, 0.0, 0.0), (30.0, 179.0, 0.0)])).is_ok());
    }
}
