//! Heading of a plot: its title, and which line is which.

use super::drawing::Shape;
use super::geometry::{Colour, Rectangle, Stroke};
use super::marker::Marker;
use super::text::{self, Anchor, Text, Weight};

const TITLE_SIZE: f64 = 17.0;
const TITLE_ROW: f64 = 22.0;
const SUBTITLE_SIZE: f64 = 12.5;
const SUBTITLE_ROW: f64 = 15.0;
/// Lines of a title, or of the text below it, before it is cut: names of sweeps may be of any length.
const MOST_LINES: usize = 3;
const LEGEND_SIZE: f64 = 13.0;
const LEGEND_ROW: f64 = 22.0;
/// The length of the sample of a series' line in the legend.
const LEGEND_LINE: f64 = 30.0;

/// Entry of the legend.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    name: String,
    colour: Colour,
    sample: Sample,
}

/// Symbol of a series in the legend.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Sample {
    Line(Option<Marker>),
    Area,
}

impl Entry {
    /// A series, drawn as a line with or without markers.
    pub(super) fn line(name: String, colour: Colour, marker: Option<Marker>) -> Self {
        Self { name, colour, sample: Sample::Line(marker) }
    }

    /// A part of the plot that has a colour of its own.
    pub(super) fn area(name: String, colour: Colour) -> Self {
        Self { name, colour, sample: Sample::Area }
    }
}

/// Adds the title, in as many lines as it needs up to [`MOST_LINES`], and returns its text and its end; an empty one takes no room.
pub(super) fn title(shapes: &mut Vec<Shape>, title: &str, left: f64, right: f64) -> (String, f64) {
    let lines = text::lines(title, TITLE_SIZE, Weight::Bold, right - left, MOST_LINES);
    let mut bottom = 12.0;
    for (number, line) in lines.iter().enumerate() {
        let baseline = 34.0 + number as f64 * TITLE_ROW;
        let heading = Text::new(line.clone(), [left, baseline], Anchor::Start, TITLE_SIZE, Colour::TEXT);
        shapes.push(Shape::Text(Text { weight: Weight::Bold, ..heading }));
        bottom = baseline + 12.0;
    }
    (lines.join(" "), bottom)
}

/// Adds smaller text below the title, in lines likewise, and returns its end; an empty one takes no room.
pub(super) fn subtitle(shapes: &mut Vec<Shape>, subtitle: &str, left: f64, right: f64, top: f64) -> f64 {
    let mut bottom = top;
    for line in text::lines(subtitle, SUBTITLE_SIZE, Weight::Regular, right - left, MOST_LINES) {
        let at = [left, bottom + 7.0];
        shapes.push(Shape::Text(Text::new(line, at, Anchor::Start, SUBTITLE_SIZE, Colour::QUIET_TEXT)));
        bottom += SUBTITLE_ROW;
    }
    bottom
}

/// Adds the legend, in as many rows as it needs, and returns its end.
pub(super) fn legend(
    shapes: &mut Vec<Shape>,
    entries: impl IntoIterator<Item = Entry>,
    left: f64,
    right: f64,
    top: f64,
) -> f64 {
    let mut members = Vec::new();
    let (mut x, mut middle) = (left, top + LEGEND_ROW / 2.0);
    for Entry { name, colour, sample } in entries {
        let text_start = LEGEND_LINE + 7.0;
        let name = text::line(&name, LEGEND_SIZE, Weight::Regular, right - left - text_start);
        let width = text_start + text::room(&name, LEGEND_SIZE, Weight::Regular);
        if x > left && x + width > right {
            (x, middle) = (left, middle + LEGEND_ROW);
        }
        match sample {
            Sample::Line(marker) => {
                let line = vec![[x, middle], [x + LEGEND_LINE, middle]];
                members.push(Shape::Polyline(line, Stroke::solid(colour, 2.0)));
                let at = [x + LEGEND_LINE / 2.0, middle];
                members.extend(marker.map(|marker| Shape::Marker(at, marker, colour)));
            }
            Sample::Area => {
                let (top, bottom) = (middle - LEGEND_SIZE / 2.0, middle + LEGEND_SIZE / 2.0);
                let area = Rectangle { left: x, top, right: x + LEGEND_LINE, bottom };
                members.push(Shape::Filled(area, colour));
            }
        }
        let at = [x + text_start, middle + LEGEND_SIZE * 0.36];
        members.push(Shape::Text(Text::new(name, at, Anchor::Start, LEGEND_SIZE, Colour::TEXT)));
        x += width + 26.0;
    }
    if members.is_empty() {
        return top;
    }
    shapes.push(Shape::Group("legend", members));
    middle + LEGEND_ROW / 2.0
}

/// Text in a plot that has nothing to show.
pub(super) fn no_data(middle: [f64; 2]) -> Shape {
    Shape::Text(Text::new("no data", middle, Anchor::Middle, TITLE_SIZE, Colour::QUIET_TEXT))
}
