//! Distinction of series, by colour and by the shape of their markers.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use super::geometry::{Colour, Position};

/// The shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Marker {
    Circle,
    Square,
    TriangleUp,
    Diamond,
    TriangleDown,
    Plus,
    Star,
    Cross,
}

/// Okabe and Ito's palette, which people with any common colour vision can distinguish, without its yellow:
/// that is too faint for lines on white.
const PALETTE: [Colour; 7] = [
    Colour(0x00, 0x72, 0xb2),
    Colour(0xd5, 0x5e, 0x00),
    Colour(0x00, 0x9e, 0x73),
    Colour(0xcc, 0x79, 0xa7),
    Colour(0xe6, 0x9f, 0x00),
    Colour(0x56, 0xb4, 0xe9),
    Colour(0x00, 0x00, 0x00),
];

/// The colour and the marker of a series by its index. With 7 colours and 8 markers, 56 series differ.
pub(super) fn series_style(index: usize) -> (Colour, Marker) {
    (PALETTE[index % PALETTE.len()], Marker::ALL[index % Marker::ALL.len()])
}

/// Colours of areas that differ in kind, at most: Okabe and Ito's whole palette.
pub(super) const KINDS: usize = PALETTE.len() + 1;

/// The colour of an area of this kind, below [`KINDS`].
pub(super) fn kind_colour(kind: usize) -> Colour {
    const YELLOW: Colour = Colour(0xf0, 0xe4, 0x42);
    PALETTE.get(kind).copied().unwrap_or(YELLOW)
}

impl Marker {
    /// The distance from a marker's middle within which all of it lies, the white rim included.
    pub(super) const REACH: f64 = 7.0;
    /// The radius of the circle; the other shapes are drawn to weigh as much.
    pub(super) const RADIUS: f64 = 4.6;
    /// The width of the white rim, half of which is outside the shape.
    pub(super) const RIM: f64 = 1.0;

    const ALL: [Self; 8] = [
        Self::Circle,
        Self::Square,
        Self::TriangleUp,
        Self::Diamond,
        Self::TriangleDown,
        Self::Plus,
        Self::Star,
        Self::Cross,
    ];

    /// The corners around the marker's middle; none for the circle.
    pub(super) fn corners(self) -> Vec<Position> {
        match self {
            Self::Circle => Vec::new(),
            Self::Square => ring(&[5.9; 4], FRAC_PI_4),
            Self::TriangleUp => ring(&[6.4; 3], -FRAC_PI_2),
            Self::Diamond => ring(&[6.2; 4], 0.0),
            Self::TriangleDown => ring(&[6.4; 3], FRAC_PI_2),
            Self::Plus => plus(0.0),
            Self::Star => ring(&[6.5, 2.7].repeat(5), -FRAC_PI_2),
            Self::Cross => plus(FRAC_PI_4),
        }
    }
}

/// Corners at these distances from the middle, at equal angles, clockwise from the angle `start`.
fn ring(distances: &[f64], start: f64) -> Vec<Position> {
    let step = TAU / distances.len() as f64;
    distances.iter().enumerate().map(|(n, distance)| polar(*distance, start + step * n as f64)).collect()
}

/// A plus sign with thick arms, turned clockwise by an angle.
fn plus(turn: f64) -> Vec<Position> {
    let (arm, half_thickness) = (6.0f64, 1.9f64);
    let (tip, inner) = (arm.hypot(half_thickness), half_thickness.hypot(half_thickness));
    let spread = half_thickness.atan2(arm);
    (0..4)
        .flat_map(|quarter| {
            let angle = turn + f64::from(quarter) * FRAC_PI_2;
            [polar(tip, angle - spread), polar(tip, angle + spread), polar(inner, angle + FRAC_PI_4)]
        })
        .collect()
}

fn polar(distance: f64, angle: f64) -> Position {
    [distance * angle.cos(), distance * angle.sin()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markers_stay_within_their_reach() {
        for marker in Marker::ALL {
            let farthest =
                marker.corners().into_iter().map(|[x, y]| x.hypot(y)).fold(Marker::RADIUS, f64::max);
            assert!(farthest + Marker::RIM / 2.0 <= Marker::REACH, "{marker:?} reaches {farthest}");
        }
    }

    #[test]
    fn fifty_six_series_differ() {
        for a in 0..56 {
            for b in 0..a {
                assert_ne!(series_style(a), series_style(b), "{a} and {b}");
            }
        }
        assert_eq!(series_style(0), series_style(56));
    }
}
