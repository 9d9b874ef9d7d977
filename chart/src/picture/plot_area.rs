//! The rectangle that data is drawn in, with its frame, grid, ticks and the names of its axes.

use super::axis::Tick;
use super::drawing::Shape;
use super::geometry::{Colour, Position, Rectangle, Stroke};
use super::text::{self, Anchor, Text, Weight};

/// The size of the text at ticks.
pub(super) const TICK_SIZE: f64 = 12.0;
/// The size of the names of axes.
const NAME_SIZE: f64 = 13.0;
/// Between the frame and the text at ticks.
const TICK_GAP: f64 = 7.0;
/// Distance of the lower edge of the page from the frame.
pub(super) const BELOW: f64 = 56.0;

/// Distance of the left edge of the page from the frame, for the vertical axis's ticks.
pub(super) fn left_margin(ticks: &[Tick]) -> f64 {
    let labels = ticks.iter().filter_map(|tick| tick.label.as_deref());
    let widest = labels.map(|label| text::room(label, TICK_SIZE, Weight::Regular)).fold(24.0, f64::max);
    (widest + TICK_GAP + 38.0).ceil()
}

/// Position of a place this far along the horizontal axis (from the left) and the vertical one (from
/// below).
pub(super) fn position(area: &Rectangle, x: f64, y: f64) -> Position {
    [area.left + x * area.width(), area.bottom - y * area.height()]
}

/// The grid, to be painted before the data: fine at ticks without a label.
pub(super) fn grid(area: &Rectangle, x_ticks: &[Tick], y_ticks: &[Tick]) -> Shape {
    let line = |tick: &Tick, from, to| {
        let colour = if tick.label.is_some() { Colour::GRID } else { Colour::FINE_GRID };
        (tick.label.is_some(), Shape::Polyline(vec![from, to], Stroke::solid(colour, 1.0)))
    };
    let vertical =
        x_ticks.iter().map(|t| line(t, position(area, t.fraction, 0.0), position(area, t.fraction, 1.0)));
    let horizontal =
        y_ticks.iter().map(|t| line(t, position(area, 0.0, t.fraction), position(area, 1.0, t.fraction)));
    let mut lines: Vec<_> = vertical.chain(horizontal).collect();
    lines.sort_by_key(|(labelled, _)| *labelled);
    Shape::Group("grid", lines.into_iter().map(|(_, line)| line).collect())
}

/// The frame, the labels of ticks and the names of the axes.
pub(super) fn axes(
    area: &Rectangle,
    x_ticks: &[Tick],
    y_ticks: &[Tick],
    x_name: &str,
    y_name: &str,
) -> Shape {
    let mut shapes = vec![Shape::Rectangle(*area, Stroke::solid(Colour::FRAME, 1.0))];
    let label = |label: &str, at, anchor| Shape::Text(Text::new(label, at, anchor, TICK_SIZE, Colour::TEXT));
    for tick in x_ticks {
        let [x, y] = position(area, tick.fraction, 0.0);
        shapes.extend(
            tick.label.iter().map(|text| label(text, [x, y + TICK_GAP + TICK_SIZE - 2.0], Anchor::Middle)),
        );
    }
    for tick in y_ticks {
        let [x, y] = position(area, 0.0, tick.fraction);
        shapes.extend(
            tick.label.iter().map(|text| label(text, [x - TICK_GAP, y + TICK_SIZE * 0.36], Anchor::End)),
        );
    }

    let name = |name: &str, room, at| {
        let name = text::line(name, NAME_SIZE, Weight::Regular, room);
        Text::new(name, at, Anchor::Middle, NAME_SIZE, Colour::TEXT)
    };
    let middle = position(area, 0.5, 0.5);
    shapes.push(Shape::Text(name(x_name, area.width(), [middle[0], area.bottom + 43.0])));
    shapes.push(Shape::Text(Text { upwards: true, ..name(y_name, area.height(), [24.0, middle[1]]) }));
    Shape::Group("axes", shapes)
}
