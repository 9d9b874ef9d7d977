//! A laid-out picture: shapes on a page, in the order in which they are painted.

use indexmap::IndexMap;

use super::geometry::{Colour, Position, Rectangle, Stroke};
use super::marker::Marker;
use super::text::Text;

/// A picture that is laid out and can be written.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    pub(super) title: String,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) shapes: Vec<Shape>,
}

impl Drawing {
    /// The width of the page in CSS pixels: the width at which text has its natural size.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The height of the page in CSS pixels.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// This picture with another below it, on one page as wide as the wider of them.
    #[must_use]
    pub(crate) fn above(mut self, mut below: Drawing) -> Drawing {
        below.shapes.iter_mut().for_each(|shape| shape.move_down(self.height));
        self.shapes.append(&mut below.shapes);
        self.width = self.width.max(below.width);
        self.height += below.height;
        self
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    /// Shapes that belong together, under a name that SVG shows as their class.
    Group(&'static str, Vec<Shape>),
    Rectangle(Rectangle, Stroke),
    /// A rectangle full of one colour.
    Filled(Rectangle, Colour),
    /// Nearly opaque white, as a background of text.
    Ground(Rectangle),
    Polyline(Vec<Position>, Stroke),
    Marker(Position, Marker, Colour),
    Mosaic(Mosaic),
    Text(Text),
}

/// A rectangle in rows and columns of cells, for more cells than a picture should have rectangles: a line of the page each.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mosaic {
    pub(super) area: Rectangle,
    /// Cells across and down.
    pub(super) size: [usize; 2],
    /// Runs of cells by colour: row from the top, first column, number of cells.
    pub(super) runs: Vec<(Colour, Vec<[usize; 3]>)>,
}

impl Mosaic {
    /// The mosaic of cells given row by row from the top; one without a colour stays empty.
    pub(super) fn new(area: Rectangle, columns: usize, cells: &[Option<Colour>]) -> Self {
        let mut runs: IndexMap<[u8; 3], Vec<[usize; 3]>> = IndexMap::new();
        for (row, cells) in cells.chunks(columns.max(1)).enumerate() {
            let mut start = 0;
            for run in cells.chunk_by(|a, b| a == b) {
                if let Some(Colour(red, green, blue)) = run[0] {
                    runs.entry([red, green, blue]).or_default().push([row, start, run.len()]);
                }
                start += run.len();
            }
        }
        let runs = runs.into_iter().map(|([red, green, blue], runs)| (Colour(red, green, blue), runs));
        Self { area, size: [columns, cells.len() / columns.max(1)], runs: runs.collect() }
    }
}

impl Shape {
    fn move_down(&mut self, distance: f64) {
        match self {
            Self::Group(_, members) => members.iter_mut().for_each(|member| member.move_down(distance)),
            Self::Rectangle(area, _)
            | Self::Filled(area, _)
            | Self::Ground(area)
            | Self::Mosaic(Mosaic { area, .. }) => {
                area.top += distance;
                area.bottom += distance;
            }
            Self::Polyline(places, _) => places.iter_mut().for_each(|place| place[1] += distance),
            Self::Marker(at, _, _) | Self::Text(Text { at, .. }) => at[1] += distance,
        }
    }

    pub(super) const GROUND_OPACITY: f32 = 0.8;
}
