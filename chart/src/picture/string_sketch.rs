//! A string in its hole, drawn to scale along its length, with diameters enlarged.

use super::axis::PlotAxis;
use super::drawing::{Drawing, Shape};
use super::geometry::{Colour, Rectangle, Stroke};
use super::heading::{self, Entry};
use super::marker::Marker;
use super::plot_area;
use super::text::{Anchor, Text};

const PAGE_WIDTH: f64 = 800.0;
const LEFT: f64 = 24.0;
const RIGHT: f64 = 776.0;
/// Height of the hole in a strip.
const HOLE: f64 = 64.0;
const TEXT_SIZE: f64 = 12.0;
/// Least length of a part that is drawn by itself \[page units\].
const LEAST: f64 = 0.5;

/// The drawing: strips of the string from the left, the top, to the right.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StringSketch {
    /// Diameter of the hole.
    pub hole: f64,
    /// Parts from the top, one after the other.
    pub parts: Vec<Part>,
    /// Blades and other narrow places: depth and diameter.
    pub gauges: Vec<[f64; 2]>,
    /// Depths of unbalance masses.
    pub unbalance: Vec<f64>,
    /// Stretches that are drawn, each in a strip of its own: depths of their ends.
    pub strips: Vec<[f64; 2]>,
    /// Depth along the string, with its unit.
    pub depth_label: String,
}

/// Stretch of one diameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Kind of the part.
    pub kind: PartKind,
    /// Depths of its ends.
    pub ends: [f64; 2],
    /// Outer diameter.
    pub diameter: f64,
}

/// Kind of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartKind {
    /// Body of drillpipe.
    Pipe,
    /// Tool joint.
    Joint,
    /// Drill collar.
    Collar,
    /// Body of a stabilizer.
    Stabilizer,
    /// Bit.
    Bit,
}

impl PartKind {
    const ALL: [Self; 5] = [Self::Pipe, Self::Joint, Self::Collar, Self::Stabilizer, Self::Bit];

    fn name(self) -> &'static str {
        match self {
            Self::Pipe => "pipe",
            Self::Joint => "tool joint",
            Self::Collar => "collar",
            Self::Stabilizer => "stabilizer",
            Self::Bit => "bit",
        }
    }

    fn colour(self) -> Colour {
        match self {
            Self::Pipe => Colour(0x9f, 0xb3, 0xc8),
            Self::Joint => Colour(0x48, 0x65, 0x81),
            Self::Collar => Colour(0x82, 0x9a, 0xb1),
            Self::Stabilizer => Colour(0xd9, 0x82, 0x2b),
            Self::Bit => Colour(0x24, 0x3b, 0x53),
        }
    }
}

impl StringSketch {
    /// The sketch laid out on a page 800 units wide.
    pub fn drawing(&self) -> Drawing {
        let mut shapes = Vec::new();
        let mut bottom = heading::legend(&mut shapes, self.legend(), LEFT, RIGHT, 4.0);
        for ends in &self.strips {
            let top = bottom + 10.0;
            let area = Rectangle { left: LEFT, top, right: RIGHT, bottom: top + HOLE };
            let Some(axis) = PlotAxis::between(ends[0], ends[1]) else { continue };
            shapes.push(self.strip(&area, &axis, *ends));
            bottom = area.bottom + 22.0;
        }
        let at = [f64::midpoint(LEFT, RIGHT), bottom + TEXT_SIZE];
        shapes.push(Shape::Text(Text::new(
            self.depth_label.clone(),
            at,
            Anchor::Middle,
            TEXT_SIZE,
            Colour::TEXT,
        )));
        Drawing { title: "String".to_owned(), width: PAGE_WIDTH, height: bottom + 2.0 * TEXT_SIZE, shapes }
    }

    fn legend(&self) -> Vec<Entry> {
        let is_drawn = |kind: &PartKind| self.parts.iter().any(|part| part.kind == *kind);
        let kinds = PartKind::ALL.into_iter().filter(is_drawn);
        let mut entries: Vec<Entry> =
            kinds.map(|kind| Entry::area(kind.name().to_owned(), kind.colour())).collect();
        if !self.gauges.is_empty() {
            entries.push(Entry::area("blades and gauges".to_owned(), Colour::TEXT));
        }
        if !self.unbalance.is_empty() {
            let marker = Some(Marker::Diamond);
            entries.push(Entry::line("unbalance mass".to_owned(), UNBALANCE, marker));
        }
        entries
    }

    fn strip(&self, area: &Rectangle, axis: &PlotAxis, [from, to]: [f64; 2]) -> Shape {
        let across =
            |depth: f64| area.left + axis.fraction(depth).unwrap_or(0.0).clamp(0.0, 1.0) * area.width();
        let middle = f64::midpoint(area.top, area.bottom);
        let around = |[start, end]: [f64; 2], diameter: f64| {
            let half = 0.5 * area.height() * (diameter / self.hole).clamp(0.0, 1.0);
            Rectangle { left: start, top: middle - half, right: end, bottom: middle + half }
        };
        let mut shapes = vec![Shape::Filled(*area, Colour(0xf4, 0xef, 0xe6))];
        // A run of parts that are too short to be seen is drawn as one, of the kind and diameter of the longest.
        let mut run: Option<(f64, Part)> = None;
        let length = |part: &Part| part.ends[1] - part.ends[0];
        for part in self.parts.iter().filter(|part| part.ends[1] > from && part.ends[0] < to) {
            let (start, mut shown) = run.take().unwrap_or((across(part.ends[0]), *part));
            if length(part) > length(&shown) {
                shown = *part;
            }
            let end = across(part.ends[1]);
            if end - start < LEAST {
                run = Some((start, shown));
            } else {
                shapes.push(Shape::Filled(around([start, end], shown.diameter), shown.kind.colour()));
            }
        }
        if let Some((start, shown)) = run {
            shapes.push(Shape::Filled(around([start, area.right], shown.diameter), shown.kind.colour()));
        }
        for [depth, diameter] in self.gauges.iter().filter(|[depth, _]| (from..=to).contains(depth)) {
            let x = across(*depth);
            shapes.push(Shape::Filled(around([x - 2.0, x + 2.0], *diameter), Colour::TEXT));
        }
        for depth in self.unbalance.iter().filter(|depth| (from..=to).contains(*depth)) {
            shapes.push(Shape::Marker([across(*depth), middle], Marker::Diamond, UNBALANCE));
        }
        for wall in [area.top, area.bottom] {
            shapes.push(Shape::Polyline(
                vec![[area.left, wall], [area.right, wall]],
                Stroke::solid(Colour::FRAME, 1.5),
            ));
        }
        for tick in axis.ticks() {
            let x = area.left + tick.fraction * area.width();
            let Some(label) = tick.label else { continue };
            shapes.push(Shape::Polyline(
                vec![[x, area.bottom], [x, area.bottom + 4.0]],
                Stroke::solid(Colour::FRAME, 1.0),
            ));
            let at = [x, area.bottom + 4.0 + plot_area::TICK_SIZE];
            shapes.push(Shape::Text(Text::new(
                label,
                at,
                Anchor::Middle,
                plot_area::TICK_SIZE,
                Colour::TEXT,
            )));
        }
        Shape::Group("strip", shapes)
    }
}

const UNBALANCE: Colour = Colour(0xb0, 0x2a, 0x37);
