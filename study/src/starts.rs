//! Dependence of a run's statistics on the friction of the equilibrium that it starts from: hysteresis.

use std::fmt;

use drillsweep_scenario::{Accuracy, StartFriction};

use super::finer::promise_of;
use super::summary::{OrbitSummary, TransientSummary};
use drillsweep_sim::solve::run::DISTURBANCE;

/// Comparison of a run's statistics with those of the same run from the other start, each of the worst node.
///
/// Tension, torque and mud of a run are those of its equilibrium, so that the two runs differ in these too.
#[derive(Debug, Clone, PartialEq)]
pub struct StartsCompared {
    /// True if orbit sizes or deviations of the radius differ by more than the bound of the accuracy.
    pub differ: bool,
    /// Largest difference of orbit sizes, relative to the larger of the two: 0 to 1.
    pub orbit_size: f64,
    /// Largest difference of the standard deviations of the radius, likewise.
    pub radius_deviation: f64,
    /// Node with the largest difference of orbit sizes, from 1 at the top; absent without recorded nodes.
    pub node: Option<usize>,
    /// Orbit sizes of that node \[m\], from the scenario's own start and from the other one.
    pub sizes: [f64; 2],
    own: StartFriction,
}

impl StartsCompared {
    /// The comparison of a run from the friction `own` with the same run from the other one, by the [bounds](promise_of) of an accuracy.
    pub fn new(
        run: &TransientSummary,
        other: &TransientSummary,
        own: StartFriction,
        accuracy: &Accuracy,
    ) -> Self {
        let promise = promise_of(accuracy);
        let nodes = || run.orbits.iter().zip(&other.orbits);
        let apart = |of: fn(&OrbitSummary) -> f64| {
            nodes()
                .map(move |(a, b)| (a.node, [of(a), of(b)]))
                .max_by(|(_, a), (_, b)| difference(*a).total_cmp(&difference(*b)))
        };
        let size = apart(|orbit| orbit.orbit_radius_rms);
        let deviation = apart(|orbit| orbit.radius_deviation);
        let sizes = size.map_or([0.0; 2], |(_, sizes)| sizes);
        let deviations = deviation.map_or([0.0; 2], |(_, deviations)| deviations);
        Self {
            differ: difference(sizes) > promise.orbit_size
                || difference(deviations) > promise.radius_deviation,
            orbit_size: difference(sizes),
            radius_deviation: difference(deviations),
            node: size.map(|(node, _)| node),
            sizes,
            own,
        }
    }
}

/// Difference of two statistics \[m\] relative to the larger; none between motions below the disturbance of an ensemble, which count
/// as rest.
fn difference([a, b]: [f64; 2]) -> f64 {
    let larger = a.abs().max(b.abs());
    if larger <= DISTURBANCE { 0.0 } else { (a - b).abs() / larger }
}

impl fmt::Display for StartsCompared {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (size, deviation) = (100.0 * self.orbit_size, 100.0 * self.radius_deviation);
        if !self.differ {
            return write!(
                formatter,
                "both starts lead to the same statistics: orbit sizes differ by {size:.2} %, deviations of the radius by {deviation:.2} % at \
                 most"
            );
        }
        write!(
            formatter,
            "the starts lead to different statistics: orbit sizes differ by {size:.1} %, deviations of the radius by {deviation:.1} % at most"
        )?;
        if let Some(node) = self.node {
            let [own, other] = self.sizes.map(|size| size * 1e3);
            write!(
                formatter,
                "; node {node} has {own:.3} mm from {} and {other:.3} mm from {}",
                self.own.name(),
                self.own.other().name()
            )?;
        }
        write!(
            formatter,
            "; either the scenario has hysteresis or the window begins before the transient of the start has decayed"
        )
    }
}

#[cfg(test)]
mod tests {
    use drillsweep_scenario::AccuracyPreset;

    use super::*;

    /// A run with orbits of the given sizes and deviations of the radius at nodes 10, 20, ...
    fn run(orbits: &[[f64; 2]]) -> TransientSummary {
        let orbit = |(place, [size, deviation]): (usize, &[f64; 2])| {
            OrbitSummary::of(10 * (place + 1), *size, *deviation)
        };
        TransientSummary::of(orbits.iter().enumerate().map(orbit).collect())
    }

    fn compared(own: &[[f64; 2]], other: &[[f64; 2]], accuracy: AccuracyPreset) -> StartsCompared {
        StartsCompared::new(&run(own), &run(other), StartFriction::Sliding, &Accuracy::Preset(accuracy))
    }

    #[test]
    fn starts_differ_beyond_the_promise_of_the_accuracy() {
        // 5 % of the size at node 20, 4 % of the deviation at node 10.
        let (own, other) = ([[1e-3, 0.96e-3], [0.95e-3, 1e-3]], [[0.99e-3, 1e-3], [1e-3, 1e-3]]);
        let standard = compared(&own, &other, AccuracyPreset::Standard);
        assert!(standard.differ);
        assert!(
            (standard.orbit_size - 0.05).abs() < 1e-12 && (standard.radius_deviation - 0.04).abs() < 1e-12
        );
        assert_eq!((standard.node, standard.sizes), (Some(20), [0.95e-3, 1e-3]));
        assert!(!compared(&own, &other, AccuracyPreset::Draft).differ);
        // The deviation alone.
        assert!(compared(&own[..1], &other[..1], AccuracyPreset::Reference).differ);
        assert!(!compared(&own[..1], &other[..1], AccuracyPreset::Standard).differ);
    }

    #[test]
    fn motions_that_are_as_good_as_rest_do_not_differ() {
        let found = compared(&[[1e-12, 0.0]], &[[1e-7, 1e-9]], AccuracyPreset::Reference);
        assert_eq!((found.differ, found.orbit_size, found.radius_deviation), (false, 0.0, 0.0));
        assert_eq!(compared(&[], &[], AccuracyPreset::Reference).node, None);
    }
}
