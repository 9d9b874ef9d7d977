//! Polylines with as few points as show: omitted points lie within a part of a pixel of the drawn line.

use std::f64::consts::{PI, TAU};

use super::geometry::Position;

/// Distance of points that are left out from the line, at most, in page units.
const TOLERANCE: f64 = 0.2;

/// The first of some points, the last, and those between that show: each left out lies within the tolerance of the line, in the order of the
/// path. Sleeve fitting (Zhao and Saalfeld, Linear-time sleeve-fitting polyline simplification algorithms, Auto-Carto 13, 1997), in one pass.
pub(super) fn simplified(points: impl IntoIterator<Item = Position>) -> Vec<Position> {
    let mut points = points.into_iter();
    let Some(first) = points.next() else { return Vec::new() };
    let mut kept = vec![first];
    let mut sleeve = Sleeve::new(first);
    for point in points {
        if !sleeve.takes(point) {
            kept.push(sleeve.end);
            sleeve = Sleeve::new(sleeve.end);
            sleeve.takes(point);
        }
    }
    if sleeve.reach > TOLERANCE {
        kept.push(sleeve.end);
    }
    kept
}

/// A segment from the last point that is kept, and the directions in which it may go.
struct Sleeve {
    start: Position,
    end: Position,
    /// A direction, and how far from it the segment may point to either side \[rad\]; none while no point is far enough to give one.
    directions: Option<(f64, [f64; 2])>,
    /// Distance of the farthest point from the start.
    reach: f64,
}

impl Sleeve {
    fn new(start: Position) -> Self {
        Self { start, end: start, directions: None, reach: 0.0 }
    }

    /// Lets the segment end at a point, if it still passes all points before within the tolerance; false otherwise.
    fn takes(&mut self, point: Position) -> bool {
        let (x, y) = (point[0] - self.start[0], point[1] - self.start[1]);
        let distance = x.hypot(y);
        // A path that turns back has its farthest point drawn.
        if distance + TOLERANCE < self.reach {
            return false;
        }
        self.reach = self.reach.max(distance);
        if distance > TOLERANCE {
            let (direction, half) = (y.atan2(x), (TOLERANCE / distance).asin());
            let (reference, [low, high]) = self.directions.unwrap_or((direction, [-PI, PI]));
            let turned = (direction - reference + PI).rem_euclid(TAU) - PI;
            if turned < low || turned > high {
                return false;
            }
            self.directions = Some((reference, [low.max(turned - half), high.min(turned + half)]));
        } else if self.directions.is_some() {
            return false;
        }
        self.end = point;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance_to_segment([x, y]: Position, [a, b]: [Position; 2]) -> f64 {
        let along = [b[0] - a[0], b[1] - a[1]];
        let length = along[0].hypot(along[1]).max(f64::MIN_POSITIVE);
        let part = ((x - a[0]) * along[0] + (y - a[1]) * along[1]) / (length * length);
        let part = part.clamp(0.0, 1.0);
        (x - a[0] - part * along[0]).hypot(y - a[1] - part * along[1])
    }

    /// Largest distance of a path from its simplification, point by point along both.
    fn largest_distance(path: &[Position], kept: &[Position]) -> f64 {
        let (mut segment, mut largest) = (0, 0.0_f64);
        for point in path {
            while segment + 2 < kept.len() && kept[segment + 1] == *point {
                segment += 1;
            }
            largest = largest.max(distance_to_segment(*point, [kept[segment], kept[segment + 1]]));
        }
        largest
    }

    #[test]
    fn simplification_is_invisible_and_removes_most_points() {
        // Forty turns of a slowly growing ellipse, a sample in 2.5 units of the page.
        let orbit: Vec<Position> = (0..20_000)
            .map(|sample| {
                let turn = TAU * f64::from(sample) / 500.0;
                let size = 150.0 + f64::from(sample) / 400.0;
                [size * turn.cos(), 0.6 * size * (turn + 0.3).sin()]
            })
            .collect();
        let kept = simplified(orbit.iter().copied());
        assert!(kept.len() < orbit.len() / 5, "{}", kept.len());
        assert_eq!((kept.first(), kept.last()), (orbit.first(), orbit.last()));
        let largest = largest_distance(&orbit, &kept);
        assert!(largest <= TOLERANCE * 1.001, "{largest}");
    }

    #[test]
    fn turning_points_stay() {
        let there_and_back: Vec<Position> =
            (0..=200).map(|step: i32| [100.0 - f64::from((100 - step).abs()), 0.0]).collect();
        assert_eq!(simplified(there_and_back), [[0.0, 0.0], [100.0, 0.0], [0.0, 0.0]]);
        let corner = [[0.0, 0.0], [5.0, 0.0], [10.0, 0.0], [10.0, 5.0], [10.0, 10.0]];
        assert_eq!(simplified(corner), [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]]);
    }

    #[test]
    fn a_path_that_does_not_move_is_a_point() {
        assert_eq!(simplified([]), [[0.0; 2]; 0]);
        assert_eq!(simplified([[3.0, 4.0]]), [[3.0, 4.0]]);
        assert_eq!(simplified(vec![[3.0, 4.0]; 1_000]), [[3.0, 4.0]]);
    }
}
