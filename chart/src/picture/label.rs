//! Placement of labels: next to their objects, clear of everything else.

use super::drawing::Shape;
use super::geometry::{Colour, Position, Rectangle};
use super::text::{Anchor, Text};

/// Cost of a line under a label, in ranks of candidates.
const CROSSING: usize = 20;

/// A plot area in which labels find their places.
#[derive(Debug)]
pub(super) struct LabelRoom {
    bounds: Rectangle,
    /// Areas that no label may cover.
    taken: Vec<Rectangle>,
    /// Lines that labels had better not cover.
    lines: Vec<[Position; 2]>,
}

impl LabelRoom {
    pub(super) fn new(bounds: Rectangle) -> Self {
        Self { bounds, taken: Vec::new(), lines: Vec::new() }
    }

    /// Keeps labels off a rectangle.
    pub(super) fn take(&mut self, rectangle: Rectangle) {
        self.taken.push(rectangle);
    }

    /// Has labels avoid the line through these places as well as they can.
    pub(super) fn avoid(&mut self, line: &[Position]) {
        self.lines.extend(line.windows(2).map(|pair| [pair[0], pair[1]]));
    }

    /// Takes the best of the candidates, which are in order of preference: within bounds, clear of what is
    /// taken, and crossed by few lines. None if no candidate is free.
    pub(super) fn place(&mut self, candidates: impl IntoIterator<Item = Rectangle>) -> Option<Rectangle> {
        let (_, best) = candidates
            .into_iter()
            .enumerate()
            .filter(|(_, candidate)| self.is_free(candidate))
            .map(|(rank, candidate)| (rank + CROSSING * self.crossings(&candidate), candidate))
            .min_by_key(|(cost, _)| *cost)?;
        self.take(best);
        Some(best)
    }

    fn is_free(&self, candidate: &Rectangle) -> bool {
        candidate.left >= self.bounds.left
            && candidate.right <= self.bounds.right
            && candidate.top >= self.bounds.top
            && candidate.bottom <= self.bounds.bottom
            && !self.taken.iter().any(|taken| overlap(taken, candidate))
    }

    fn crossings(&self, candidate: &Rectangle) -> usize {
        self.lines.iter().filter(|line| crosses(line, candidate)).count()
    }
}

/// Places for a label of this size about a point, best first: right and left, then above and below, then
/// farther away.
pub(super) fn around([x, y]: Position, width: f64, height: f64, gap: f64) -> Vec<Rectangle> {
    let at = |left: f64, top: f64| Rectangle { left, top, right: left + width, bottom: top + height };
    [gap, gap * 1.9]
        .into_iter()
        .flat_map(|gap| {
            let slant = gap * 0.6;
            let (left, middle, right) = (x - gap - width, x - width / 2.0, x + gap);
            let (above, level, below) = (y - gap - height, y - height / 2.0, y + gap);
            let (near_left, near_right) = (x - slant - width, x + slant);
            let (near_above, near_below) = (y - slant - height, y + slant);
            [
                at(right, level),
                at(near_right, near_above),
                at(near_right, near_below),
                at(middle, above),
                at(left, level),
                at(near_left, near_above),
                at(near_left, near_below),
                at(middle, below),
            ]
        })
        .collect()
}

/// A label and the ground it stands on, in the rectangle made for it.
pub(super) fn label_shapes(
    label: String,
    place: &Rectangle,
    anchor: Anchor,
    size: f64,
    colour: Colour,
) -> [Shape; 2] {
    let x = match anchor {
        Anchor::Start => place.left,
        Anchor::Middle => f64::midpoint(place.left, place.right),
        Anchor::End => place.right,
    };
    let text = Text::new(label, [x, place.bottom - size * 0.15], anchor, size, colour);
    [Shape::Ground(*place), Shape::Text(text)]
}

fn overlap(a: &Rectangle, b: &Rectangle) -> bool {
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom
}

/// True if a straight line passes through a rectangle, after Liang and Barsky.
fn crosses([from, to]: &[Position; 2], rectangle: &Rectangle) -> bool {
    let (mut enters, mut leaves) = (0.0f64, 1.0f64);
    let sides = [
        (from[0], to[0], rectangle.left, rectangle.right),
        (from[1], to[1], rectangle.top, rectangle.bottom),
    ];
    for (start, end, low, high) in sides {
        let run = end - start;
        if run == 0.0 {
            if start < low || start > high {
                return false;
            }
            continue;
        }
        let (a, b) = ((low - start) / run, (high - start) / run);
        enters = enters.max(a.min(b));
        leaves = leaves.min(a.max(b));
    }
    enters <= leaves
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: Rectangle = Rectangle { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 };

    fn square(left: f64, top: f64) -> Rectangle {
        Rectangle { left, top, right: left + 10.0, bottom: top + 10.0 }
    }

    #[test]
    fn a_line_crosses_a_rectangle_or_not() {
        let middle = square(45.0, 45.0);
        for (line, expected) in [
            ([[0.0, 0.0], [100.0, 100.0]], true),
            ([[0.0, 50.0], [100.0, 50.0]], true),
            ([[50.0, 0.0], [50.0, 100.0]], true),
            ([[47.0, 47.0], [48.0, 48.0]], true),
            ([[0.0, 0.0], [40.0, 40.0]], false),
            ([[0.0, 40.0], [100.0, 40.0]], false),
            ([[0.0, 80.0], [80.0, 0.0]], false),
        ] {
            assert_eq!(crosses(&line, &middle), expected, "{line:?}");
        }
    }

    #[test]
    fn the_first_free_candidate_without_lines_is_taken() {
        let mut room = LabelRoom::new(PAGE);
        room.take(square(20.0, 20.0));
        room.avoid(&[[40.0, 0.0], [40.0, 100.0]]);
        let candidates =
            [square(95.0, 0.0), square(25.0, 25.0), square(35.0, 0.0), square(60.0, 0.0), square(80.0, 0.0)];
        assert_eq!(room.place(candidates), Some(square(60.0, 0.0)));
        assert_eq!(room.place(candidates), Some(square(80.0, 0.0)));
        assert_eq!(room.place(candidates), Some(square(35.0, 0.0)));
        assert_eq!(room.place(candidates), None);
    }

    #[test]
    fn no_place_about_a_point_covers_it() {
        let marker = Rectangle { left: 44.0, top: 44.0, right: 56.0, bottom: 56.0 };
        for candidate in around([50.0, 50.0], 30.0, 10.0, 10.0) {
            assert!(!overlap(&candidate, &marker), "{candidate:?}");
        }
    }
}
